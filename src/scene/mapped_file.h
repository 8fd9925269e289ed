#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <utility>

#include "base/error.h"

namespace kadr {

using ByteView = std::span<const std::uint8_t>;

/// The bytes of a file. The system reads them when they are looked at: what nobody asks for is neither read nor in memory.
/// A file must not be made shorter while it is open.
class MappedFile {
public:
    MappedFile() = default;
    /// A regular file of less than 4 GiB, which is what glTF can hold.
    /// @throws InputError  what `on_failure` describes, and why
    MappedFile(const std::filesystem::path& path, const Diagnostic& on_failure);
    MappedFile(MappedFile&& other) noexcept : bytes_(std::exchange(other.bytes_, {})) {}
    MappedFile& operator=(MappedFile&& other) noexcept {
        std::swap(bytes_, other.bytes_);
        return *this;
    }
    ~MappedFile();

    ByteView bytes() const { return bytes_; }

private:
    ByteView bytes_;
};

}  // namespace kadr
