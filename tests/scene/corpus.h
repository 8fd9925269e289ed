#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace kadr::test {

/// The folder of outside glTF files: KADR_TEST_ASSETS, or ../shared/assets beside the repository.
inline std::filesystem::path assets_folder() {
    const char* set = std::getenv("KADR_TEST_ASSETS");
    return set ? std::filesystem::path(set) : std::filesystem::path(KADR_SOURCE_DIR) / ".." / "shared" / "assets";
}

/// The .gltf and .glb files below a folder, sorted.
inline std::vector<std::filesystem::path> gltf_files(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
        if (entry.path().extension() == ".gltf" || entry.path().extension() == ".glb") files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

#define KADR_NEED_ASSETS()                                                                                          \
    if (!std::filesystem::is_directory(kadr::test::assets_folder()))                                                \
    GTEST_SKIP() << "no outside assets at " << kadr::test::assets_folder() << "; set KADR_TEST_ASSETS to their folder"

}  // namespace kadr::test
