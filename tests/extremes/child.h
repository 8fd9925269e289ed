#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace kadr::test {

/// How a process that did some work came to its end.
struct ChildReport {
    std::string ended;              ///< "": normally; else "by signal 11 (Segmentation fault)", "with exit code 3"
    std::string last;               ///< what it had begun when it ended
    std::string complaints;         ///< lines
    std::size_t peak_memory_bytes = 0;
};

/// What the work tells the process that waits for it.
class ChildLog {
public:
    explicit ChildLog(int pipe) : pipe_(pipe) {}
    void begin(const std::string& step) { send('>', step); }
    void complain(const std::string& text) { send('!', text); }

private:
    void send(char kind, const std::string& text);
    int pipe_;
};

/// Does some work in a process of its own, which an endless loop does not outlive: it has five minutes.
/// @pre the calling process has no other threads
ChildReport in_child(const std::function<void(ChildLog&)>& work);

}  // namespace kadr::test
