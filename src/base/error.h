#pragma once

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace kadr {

/// A place in a text file. Lines and columns count from 1; line 0 means "the whole file" and an empty file
/// means "no file" (a command-line argument, say).
struct SourceLocation {
    std::string file;
    int line = 0;
    int column = 0;
    bool operator==(const SourceLocation&) const = default;
};

/// One thing wrong with the input, in the order in which a reader wants it: where, what was found, what was
/// expected and what to do.
struct Diagnostic {
    SourceLocation where;
    std::string found;       ///< "shutter.angle is 540 deg"; no trailing full stop
    std::string excerpt;     ///< the offending line of the file, untrimmed; empty when there is none
    int excerpt_length = 1;  ///< characters to underline from where.column on
    std::string expected;    ///< "expected 0 to 360 deg; use 360 deg to ..."; may be empty
    bool warning = false;

    /// The message as a person reads it: `file:line:column: error: found`, excerpt, caret line, expectation.
    /// Ends without a newline.
    std::string text() const;
};

/// Bad input: exit code 2. Holds every problem that was found, not only the first.
class InputError : public std::runtime_error {
public:
    explicit InputError(std::vector<Diagnostic> diagnostics);
    explicit InputError(Diagnostic diagnostic);
    /// A problem without a place in a file (usage, a missing file named on the command line).
    explicit InputError(std::string found, std::string expected = {});
    const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

private:
    std::vector<Diagnostic> diagnostics_;
};

/// The render failed although the input was right (full disk, failing ffmpeg, out of memory): exit code 1.
class RenderError : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The user asked to stop (SIGINT, SIGTERM): exit code 130.
class Interrupted : public std::runtime_error {
public:
    Interrupted() : std::runtime_error("interrupted") {}
};

}  // namespace kadr
