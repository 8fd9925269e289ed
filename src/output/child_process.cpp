#include "output/child_process.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <utility>

#include "base/error.h"

extern char** environ;

namespace kadr {
namespace {

namespace fs = std::filesystem;

// Enough for the lines in which ffmpeg says what went wrong.
constexpr std::size_t kErrorTail = 4096;
constexpr std::size_t kUnlimited = static_cast<std::size_t>(-1);
// A frame of 1280 x 720 is 2.8 MB; the default pipe of 64 kB wakes both sides 43 times for it.
constexpr int kPipeBytes = 1 << 20;

/// Writing to a program that has ended is an error to report, not a reason to die.
void ignore_broken_pipes() {
    static const auto previous = ::signal(SIGPIPE, SIG_IGN);
    static_cast<void>(previous);
}

struct Pipe {
    int read = -1, write = -1;
    Pipe() {
        int ends[2];
        if (::pipe2(ends, O_CLOEXEC) != 0) throw RenderError(fmt::format("cannot make a pipe: {}", std::strerror(errno)));
        read = ends[0];
        write = ends[1];
    }
    ~Pipe() {
        for (const int end : {read, write})
            if (end >= 0) ::close(end);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;
};

/// Settings of posix_spawn, released together.
struct SpawnSettings {
    posix_spawn_file_actions_t files;
    posix_spawnattr_t attributes;
    SpawnSettings() {
        posix_spawn_file_actions_init(&files);
        posix_spawnattr_init(&attributes);
        sigset_t signals;
        sigemptyset(&signals);
        posix_spawnattr_setsigmask(&attributes, &signals);
        sigaddset(&signals, SIGPIPE);   // an ignored signal would stay ignored in the child
        sigaddset(&signals, SIGXFSZ);
        posix_spawnattr_setsigdefault(&attributes, &signals);
        posix_spawnattr_setpgroup(&attributes, 0);
        posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    }
    ~SpawnSettings() {
        posix_spawn_file_actions_destroy(&files);
        posix_spawnattr_destroy(&attributes);
    }
    SpawnSettings(const SpawnSettings&) = delete;
    SpawnSettings& operator=(const SpawnSettings&) = delete;
};

/// Reads to the end, keeps the last `limit` bytes.
void drain(int file, std::string& text, std::size_t limit) {
    char buffer[4096];
    for (;;) {
        const ssize_t count = ::read(file, buffer, sizeof buffer);
        if (count < 0 && errno == EINTR) continue;
        if (count <= 0) break;
        text.append(buffer, static_cast<std::size_t>(count));
        if (text.size() > limit) text.erase(0, text.size() - limit);
    }
    ::close(file);
}

std::string without_trailing_newlines(std::string text) {
    while (!text.empty() && (text.back() == '\n' || text.back() == '\r')) text.pop_back();
    return text;
}

}  // namespace

std::optional<fs::path> find_program(const std::string& name) {
    const char* path = std::getenv("PATH");
    std::string folders = path ? path : "/usr/local/bin:/usr/bin:/bin";
    for (std::size_t begin = 0; begin <= folders.size();) {
        const std::size_t end = std::min(folders.find(':', begin), folders.size());
        const fs::path candidate = fs::path(folders.substr(begin, end - begin)) / name;
        std::error_code none;
        if (fs::is_regular_file(candidate, none) && ::access(candidate.c_str(), X_OK) == 0) return candidate;
        begin = end + 1;
    }
    return std::nullopt;
}

ChildProcess::ChildProcess(const Arguments& arguments) {
    ignore_broken_pipes();
    Pipe input, output, errors;
    SpawnSettings settings;
    posix_spawn_file_actions_adddup2(&settings.files, input.read, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&settings.files, output.write, STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&settings.files, errors.write, STDERR_FILENO);
    std::vector<char*> words;
    for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
    words.push_back(nullptr);
    const int error = ::posix_spawn(&process_, words[0], &settings.files, &settings.attributes, words.data(), environ);
    if (error != 0) throw RenderError(fmt::format("cannot start '{}': {}", arguments[0], std::strerror(error)));
    ::fcntl(input.write, F_SETPIPE_SZ, kPipeBytes);   // only faster; the default works too
    input_ = std::exchange(input.write, -1);
    output_reader_ = std::thread(drain, std::exchange(output.read, -1), std::ref(output_), kUnlimited);
    error_reader_ = std::thread(drain, std::exchange(errors.read, -1), std::ref(errors_), kErrorTail);
}

ChildProcess::~ChildProcess() {
    if (process_ >= 0) ::kill(-process_, SIGKILL);
    wait();
}

bool ChildProcess::write(std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const ssize_t count = ::write(input_, bytes.data(), bytes.size());
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) return false;
        bytes = bytes.subspan(static_cast<std::size_t>(count));
    }
    return true;
}

void ChildProcess::close_input() {
    if (input_ >= 0) ::close(std::exchange(input_, -1));
}

int ChildProcess::wait() {
    close_input();
    if (process_ < 0) return status_;
    int status = 0;
    while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
    }
    process_ = -1;
    status_ = WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    output_reader_.join();
    error_reader_.join();
    errors_ = without_trailing_newlines(std::move(errors_));
    return status_;
}

ProgramResult run_program(const Arguments& arguments) {
    ChildProcess process(arguments);
    const int status = process.wait();
    return {status, process.output(), process.error_tail()};
}

}  // namespace kadr
