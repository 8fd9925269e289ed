#include "output/atomic_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <signal.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <string_view>
#include <utility>

#include "base/error.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kPrefix = ".kadr-";
constexpr std::string_view kInfix = ".tmp";

/// What a person can do about an error of the operating system.
const char* remedy(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT: return "; free some space and run the same command again: complete frames are kept";
        case EFBIG: return "; raise the limit on the size of files (ulimit -f)";
        case EACCES:
        case EPERM:
        case EROFS: return "; choose another folder or change its permissions";
        default: return "";
    }
}

[[noreturn]] void fail(std::string_view action, const fs::path& path, int error) {
    throw RenderError(fmt::format("cannot {} '{}': {}{}", action, path.string(), std::strerror(error), remedy(error)));
}

/// An open file; closes on the way out.
class File {
public:
    File(const fs::path& path, int flags, const fs::path& shown) : number_(::open(path.c_str(), flags | O_CLOEXEC, 0666)) {
        if (number_ < 0) fail("write", shown, errno);
    }
    ~File() {
        if (number_ >= 0) ::close(number_);
    }
    File(const File&) = delete;
    File& operator=(const File&) = delete;
    int number() const { return number_; }
    /// Some file systems report a full disk only here. @return the error, or 0
    int close() { return ::close(std::exchange(number_, -1)) == 0 ? 0 : errno; }

private:
    int number_;
};

/// Some file systems (FUSE, procfs) cannot sync; that is no reason to refuse to write.
bool sync_failed(int file) { return ::fsync(file) != 0 && errno != EINVAL && errno != ENOSYS && errno != ENOTSUP; }

/// @return the error, or 0
int write_all(int file, std::span<const unsigned char> bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(file, bytes.data(), bytes.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes = bytes.subspan(static_cast<std::size_t>(written));
    }
    return 0;
}

/// Without this a full file-size limit kills the process before it can remove the half file.
void ignore_file_size_signal() {
    static const auto previous = ::signal(SIGXFSZ, SIG_IGN);
    static_cast<void>(previous);
}

void write_synced_as(const fs::path& path, std::span<const unsigned char> bytes, const fs::path& shown) {
    ignore_file_size_signal();
    File file(path, O_WRONLY | O_CREAT | O_TRUNC, shown);
    int error = write_all(file.number(), bytes);
    if (error == 0 && sync_failed(file.number())) error = errno;
    const int close_error = file.close();
    if (error == 0) error = close_error;
    if (error == 0) return;
    ::unlink(path.c_str());
    fail("write", shown, error);
}

void sync_folder(const fs::path& folder) {
    File file(folder.empty() ? fs::path(".") : folder, O_RDONLY | O_DIRECTORY, folder);
    if (sync_failed(file.number())) fail("sync", folder, errno);
}

/// The process that a temporary file belongs to; nothing when the name is not one of ours.
std::optional<pid_t> owner_of(const std::string& name) {
    if (!name.starts_with(kPrefix) || name.find(kInfix) == std::string::npos) return std::nullopt;
    pid_t process = 0;
    const char* begin = name.data() + kPrefix.size();
    const auto [end, error] = std::from_chars(begin, name.data() + name.size(), process);
    if (error != std::errc() || *end != '-' || process <= 0) return std::nullopt;
    return process;
}

/// Seconds since the epoch at which the machine started, by the kernel.
std::optional<double> boot_time() {
    std::ifstream stat("/proc/stat");
    for (std::string word; stat >> word;)
        if (double seconds = 0; word == "btime" && stat >> seconds) return seconds;
    return std::nullopt;
}

/// Seconds since the epoch at which a process started (proc(5): field 22 of stat, in clock ticks since boot).
std::optional<double> start_time(pid_t process) {
    std::ifstream file(fmt::format("/proc/{}/stat", process));
    std::string text{std::istreambuf_iterator<char>(file), {}};
    const std::size_t name_end = text.rfind(')');
    if (name_end == std::string::npos) return std::nullopt;
    text = text.substr(name_end + 1);
    constexpr int kFieldsAfterName = 20;
    std::string field;
    std::size_t at = 0;
    for (int i = 0; i < kFieldsAfterName; ++i) {
        at = text.find_first_not_of(' ', at);
        if (at == std::string::npos) return std::nullopt;
        const std::size_t end = std::min(text.find(' ', at), text.size());
        field = text.substr(at, end - at);
        at = end;
    }
    const std::optional<double> boot = boot_time();
    if (!boot) return std::nullopt;
    return *boot + std::strtod(field.c_str(), nullptr) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

/// Process numbers come back, in containers at every start, so a living process is not enough: it must be old enough.
bool is_leftover(const fs::path& path, pid_t owner) {
    if (::kill(owner, 0) != 0 && errno == ESRCH) return true;
    struct stat status {};
    if (::stat(path.c_str(), &status) != 0) return false;
    constexpr double kClockSlack_s = 2;
    const std::optional<double> started = start_time(owner);
    return started && static_cast<double>(status.st_mtime) + kClockSlack_s < *started;
}

}  // namespace

fs::path temporary_name(const fs::path& path) {
    return path.parent_path() /
           fmt::format("{}{}-{}{}{}", kPrefix, ::getpid(), path.stem().string(), kInfix, path.extension().string());
}

void create_folder_of(const fs::path& path) {
    if (!path.has_parent_path()) return;
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    if (error) fail("create the folder", path.parent_path(), error.value());
}

void write_synced(const fs::path& path, std::span<const unsigned char> bytes) { write_synced_as(path, bytes, path); }

void rename_synced(const fs::path& from, const fs::path& to) {
    if (::rename(from.c_str(), to.c_str()) != 0) {
        const int error = errno;
        ::unlink(from.c_str());
        fail("write", to, error);
    }
    sync_folder(to.parent_path());
}

void write_atomically(const fs::path& path, std::span<const unsigned char> bytes) {
    const fs::path temporary = temporary_name(path);
    write_synced_as(temporary, bytes, path);
    rename_synced(temporary, path);
}

void sync_file(const fs::path& path) {
    const File file(path, O_RDONLY, path);
    if (sync_failed(file.number())) fail("sync", path, errno);
}

void remove_dead_temporaries(const fs::path& folder) {
    std::error_code none;
    for (fs::directory_iterator entry(folder, none), end; !none && entry != end; entry.increment(none)) {
        const std::optional<pid_t> owner = owner_of(entry->path().filename().string());
        std::error_code ignored;
        if (owner && is_leftover(entry->path(), *owner)) fs::remove(entry->path(), ignored);
    }
}

}  // namespace kadr
