#include "scene/mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace kadr {

namespace {

constexpr std::uint64_t kLargestFile = 4ull << 30;  // bytes; GLB cannot be larger

/// Closes when it goes; the mapping stays.
class OpenFile {
public:
    explicit OpenFile(const std::filesystem::path& path) : number_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {}
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;
    ~OpenFile() {
        if (number_ >= 0) ::close(number_);
    }
    int number() const { return number_; }

private:
    int number_;
};

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, const Diagnostic& on_failure) {
    const auto refuse = [&](const std::string& why) {
        Diagnostic diagnostic = on_failure;
        diagnostic.found += ": " + why;
        throw InputError(std::move(diagnostic));
    };
    std::error_code failed;
    const auto status = std::filesystem::status(path, failed);
    if (!std::filesystem::exists(status)) refuse("there is no such file");
    if (!std::filesystem::is_regular_file(status)) refuse("it is not a regular file");
    const std::uintmax_t size = std::filesystem::file_size(path, failed);
    if (failed) refuse(failed.message());
    if (size >= kLargestFile) refuse(fmt::format("it has {} bytes; the limit is 4 GiB", size));
    const OpenFile file(path);
    if (file.number() < 0) refuse("it cannot be read");
    if (size == 0) return;
    void* const address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.number(), 0);
    if (address == MAP_FAILED) refuse(fmt::format("it cannot be read ({})", std::strerror(errno)));
    bytes_ = {static_cast<const std::uint8_t*>(address), size};
}

MappedFile::~MappedFile() {
    if (!bytes_.empty()) ::munmap(const_cast<std::uint8_t*>(bytes_.data()), bytes_.size());
}

}  // namespace kadr
