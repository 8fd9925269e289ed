#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "base/detached_work.h"
#include "base/error.h"
#include "cli/command_line.h"
#include "cli/commands.h"

namespace {

constexpr int kDone = 0, kFailed = 1, kBadInput = 2, kInterrupted = 130;

void complain(const std::string& text) { std::fprintf(stderr, "%s\n", text.c_str()); }

int fail(const std::string& reason) {
    complain("error: " + reason);
    return kFailed;
}

int run(const std::vector<std::string>& arguments) {
    const kadr::Invocation invocation = kadr::parse_command_line(arguments);
    if (invocation.text.empty()) return kadr::run_command(invocation);
    std::fputs(invocation.text.c_str(), stdout);
    return kDone;
}

/// What ends the program, as an exit code.
int guarded(int argc, char** argv) {
    try {
        return run(std::vector<std::string>(argv + 1, argv + argc));
    } catch (const kadr::InputError& error) {
        for (const kadr::Diagnostic& diagnostic : error.diagnostics()) complain(diagnostic.text());
        return kBadInput;
    } catch (const kadr::Interrupted&) {
        complain("interrupted: complete frames stay, and the same command goes on from there");
        return kInterrupted;
    } catch (const std::bad_alloc&) {
        return fail("out of memory");
    } catch (const std::exception& error) {
        return fail(error.what());
    }
}

}  // namespace

int main(int argc, char** argv) {
    kadr::install_interrupt_handlers();
    const int code = guarded(argc, argv);
    if (!kadr::DetachedWork::is_running()) return code;
    std::fflush(nullptr);
    std::_Exit(code);  // kernels are still being compiled, and nobody waits for them
}
