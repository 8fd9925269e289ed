#include <csignal>
#include <unistd.h>

#include "render/render_job.h"

namespace kadr {
namespace {

constexpr int kInterruptedExitCode = 130;

std::atomic<bool> g_interrupt_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "set in a signal handler");

void on_signal(int) {
    if (g_interrupt_requested.exchange(true)) _exit(kInterruptedExitCode);
}

}  // namespace

std::atomic<bool>& interrupt_requested() { return g_interrupt_requested; }

void install_interrupt_handlers() {
    struct sigaction action = {};
    action.sa_handler = on_signal;
    sigemptyset(&action.sa_mask);
    // Restarted calls keep a half-finished write whole; the flag is looked at between them.
    action.sa_flags = SA_RESTART;
    for (const int signal_number : {SIGINT, SIGTERM}) sigaction(signal_number, &action, nullptr);
    // A closed pipe (ffmpeg gone, `kadr ... | head`) is an error of the write that meets it, not the end of the process.
    std::signal(SIGPIPE, SIG_IGN);
}

}  // namespace kadr
