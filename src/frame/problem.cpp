#include "frame/problem.h"

#include <fstream>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/references.h"

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

Diagnostic problem_of_node(const BoundShot& shot, int node, std::string_view what, double time_s, std::string expected) {
    const int file = shot.bindings().rig.file_of(node);
    return problem_at(shot.shot().scenes[static_cast<std::size_t>(file)].where,
                      fmt::format("node '{}' {} at {} s", node_path(shot.scene(), file, node), what, format_number(time_s)), std::move(expected));
}

}  // namespace kadr
