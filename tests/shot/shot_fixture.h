#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "shot/shot_parser.h"

namespace kadr {

/// Runs in a folder of its own that holds a.glb, b.gltf and sky.exr: the parser checks that assets exist, and messages
/// name files relative to the working folder.
class ShotTest : public ::testing::Test {
protected:
    void SetUp() override {
        before_ = std::filesystem::current_path();
        folder_ = std::filesystem::temp_directory_path() / ("kadr-shot-test-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
        folder_ = std::filesystem::canonical(folder_);
        for (const char* name : {"a.glb", "b.gltf", "sky.exr"}) std::ofstream(folder_ / name) << "x";
        std::filesystem::current_path(folder_);
    }
    void TearDown() override {
        std::filesystem::current_path(before_);
        std::filesystem::remove_all(folder_);
    }

    static constexpr const char* kBase =
        "kadr: 1\nscenes: [ a.glb ]\ncamera: {}\n";  // what a test's lines follow: line 4

    /// A shot of the required keys and some more lines.
    static Shot parse(const std::string& lines, const ShotOverrides& overrides = {}) {
        return parse_shot_text(kBase + lines, "shot.yaml", overrides);
    }
    static Shot parse_camera(const std::string& camera) {
        return parse_shot_text("kadr: 1\nscenes: [ a.glb ]\ncamera: " + camera + "\n", "shot.yaml");
    }
    static Shot parse_scene(const std::string& scene) {
        return parse_shot_text("kadr: 1\nscenes: [ " + scene + " ]\ncamera: {}\n", "shot.yaml");
    }

    /// All messages of a text, or "no error".
    static std::string errors_of(const std::string& text, const ShotOverrides& overrides = {}) {
        try {
            parse_shot_text(text, "shot.yaml", overrides);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    }

    std::filesystem::path folder_;

private:
    std::filesystem::path before_;
};

}  // namespace kadr
