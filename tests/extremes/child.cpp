#include "extremes/child.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstring>
#include <stdexcept>

namespace kadr::test {

namespace {

constexpr unsigned kLongest_s = 300;  // a child takes seconds, with sanitizers and beside others up to a minute

constexpr std::size_t kMostText = 20000;  // of complaints: the first tell enough

/// The rest of a pipe, until its other end is closed.
std::string read_all(int pipe) {
    std::string text;
    char buffer[4096];
    for (ssize_t count; (count = ::read(pipe, buffer, sizeof buffer)) > 0;) text.append(buffer, static_cast<std::size_t>(count));
    return text;
}

std::string end_of(int status) {
    if (WIFSIGNALED(status)) return "by signal " + std::to_string(WTERMSIG(status)) + " (" + strsignal(WTERMSIG(status)) + ")";
    return WEXITSTATUS(status) == 0 ? "" : "with exit code " + std::to_string(WEXITSTATUS(status));
}

/// Messages of several lines end with a zero byte.
void add_messages(ChildReport& report, const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\0', at), text.size());
        if (text[at] == '>') report.last = text.substr(at + 1, end - at - 1);
        else if (report.complaints.size() < kMostText) report.complaints += text.substr(at + 1, end - at - 1) + "\n";
        at = end + 1;
    }
}

}  // namespace

void ChildLog::send(char kind, const std::string& text) {
    const std::string message = kind + text + '\0';
    if (::write(pipe_, message.data(), message.size()) != static_cast<ssize_t>(message.size())) ::_exit(3);
}

ChildReport in_child(const std::function<void(ChildLog&)>& work) {
    int ends[2];
    if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
    const pid_t child = ::fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) {
        ::close(ends[0]);
        ::alarm(kLongest_s);
        ChildLog log(ends[1]);
        try {
            work(log);
        } catch (const std::exception& error) {
            log.complain(std::string("throws ") + error.what());
        }
        ::_exit(0);
    }
    ::close(ends[1]);
    ChildReport report;
    add_messages(report, read_all(ends[0]));
    ::close(ends[0]);
    int status = 0;
    rusage usage{};
    ::wait4(child, &status, 0, &usage);
    report.ended = end_of(status);
    report.peak_memory_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
    return report;
}

}  // namespace kadr::test
