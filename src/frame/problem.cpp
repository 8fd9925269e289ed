#include "frame/problem.h"

#include <fstream>

namespace kadr {

namespace {

std::string line_of(const SourceLocation& where) {
    if (where.file.empty() || where.line <= 0) return {};
    std::ifstream file(where.file);
    std::string line;
    for (int i = 0; i < where.line; ++i)
        if (!std::getline(file, line)) return {};
    if (!line.empty() && line.back() == '\r') line.pop_back();
    return line;
}

}  // namespace

Diagnostic problem_at(const SourceLocation& where, std::string found, std::string expected) {
    Diagnostic problem;
    problem.where = where;
    problem.found = std::move(found);
    problem.excerpt = line_of(where);
    problem.expected = std::move(expected);
    return problem;
}

Diagnostic warning_at(const SourceLocation& where, std::string found, std::string expected) {
    Diagnostic problem = problem_at(where, std::move(found), std::move(expected));
    problem.warning = true;
    return problem;
}

}  // namespace kadr
