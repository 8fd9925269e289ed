#include "base/hash.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "base/error.h"

namespace kadr {
namespace {

template <class... Values>
Hash hash_of(const Values&... values) {
    Hasher hasher;
    (hasher.add(values), ...);
    return hasher.finish();
}

TEST(Hasher, SeparatesValues) {
    EXPECT_NE(hash_of(std::string_view("ab"), std::string_view("c")),
              hash_of(std::string_view("a"), std::string_view("bc")));
    EXPECT_NE(hash_of(std::string_view("")), hash_of());
    EXPECT_EQ(hash_of(0.0), hash_of(-0.0));
    EXPECT_NE(hash_of(0.0), hash_of(5e-324));
}

TEST(Hasher, PrintsThirtyTwoHexDigits) {
    // The empty input's XXH3-128, as `xxhsum -H2` prints it.
    EXPECT_EQ(hash_of().hex(), "99aa06d3014798d86001c324468d497f");
}

TEST(HashFile, HashesTheContent) {
    const auto folder = std::filesystem::temp_directory_path() /
                        ("kadr-hash-test-" + std::to_string(::testing::UnitTest::GetInstance()->random_seed()));
    std::filesystem::create_directories(folder);
    std::ofstream(folder / "empty");
    std::ofstream(folder / "a") << "a";
    EXPECT_EQ(hash_file(folder / "empty"), Hasher().finish());
    EXPECT_NE(hash_file(folder / "a"), hash_file(folder / "empty"));
    EXPECT_THROW(hash_file(folder / "missing"), InputError);
    EXPECT_THROW(hash_file(folder), InputError);
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace kadr
