#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kadr {

class BoundShot;

/// A diagnostic at a place of the shot file, with the line that it speaks of where the file can be read.
Diagnostic problem_at(const SourceLocation& where, std::string found, std::string expected);
Diagnostic warning_at(const SourceLocation& where, std::string found, std::string expected);

/// Runs a step and keeps what it complains about, so that all problems of a shot come at once.
template <class Step>
void collect(std::vector<Diagnostic>& problems, Step step) {
    try {
        step();
    } catch (const InputError& error) {
        problems.insert(problems.end(), error.diagnostics().begin(), error.diagnostics().end());
    }
}

/// "node 'scene/Parent/Node' has no place at 0.5 s", where the shot names the node's file.
Diagnostic problem_of_node(const BoundShot& shot, int node, std::string_view what, double time_s, std::string expected);

}  // namespace kadr
