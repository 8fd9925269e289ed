#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <vector>

namespace kadr {

/// The program of this name on the PATH; nothing when there is none.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// Command line: the program, then its arguments. No shell is involved.
using Arguments = std::vector<std::string>;

/// A program that runs beside this one, in a process group of its own: Ctrl-C on the terminal reaches only this program,
/// which then ends its children in order.
class ChildProcess {
public:
    /// @throws RenderError  when it cannot be started
    explicit ChildProcess(const Arguments& arguments);
    ~ChildProcess();   ///< still running: killed
    ChildProcess(const ChildProcess&) = delete;
    ChildProcess& operator=(const ChildProcess&) = delete;

    /// Writes to its standard input. @return false when it does not read any more
    bool write(std::span<const unsigned char> bytes);
    /// Ends its input, waits for its end. @return exit status, or 128 + signal; again the same when called again
    int wait();
    /// After wait(): all of its standard output, and the last lines of its standard error.
    const std::string& output() const { return output_; }
    const std::string& error_tail() const { return errors_; }

private:
    void close_input();

    int input_ = -1;
    int process_ = -1;
    int status_ = 0;
    std::string output_, errors_;
    std::thread output_reader_, error_reader_;
};

/// Runs a program without input to its end.
struct ProgramResult {
    int status = 0;
    std::string output, error_tail;
};
ProgramResult run_program(const Arguments& arguments);

}  // namespace kadr
