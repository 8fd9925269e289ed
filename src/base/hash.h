#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace kadr {

/// 128-bit content hash (XXH3), printed as 32 lower-case hex digits. Stable over machines and versions of Kadr.
struct Hash {
    std::uint64_t low = 0, high = 0;
    bool operator==(const Hash&) const = default;
    std::string hex() const;
};

/// Feeds values one after another; every value is preceded by its length, so "ab"+"c" differs from "a"+"bc".
class Hasher {
public:
    Hasher();
    ~Hasher();
    Hasher(const Hasher&) = delete;
    Hasher& operator=(const Hasher&) = delete;
    void add(std::string_view bytes);
    void add(double value);  ///< by bits; -0 counts as 0
    void add(std::int64_t value);
    Hash finish() const;

private:
    void* state_;
};

/// Hash of a file's content. @throws InputError when it cannot be read.
Hash hash_file(const std::filesystem::path& path);

}  // namespace kadr
