#pragma once

#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "film/film.h"

namespace kadr {
namespace fs = std::filesystem;
}

namespace kadr::test {

/// An empty folder that goes with the test.
class TemporaryFolder {
public:
    TemporaryFolder() {
        std::string name = (fs::temp_directory_path() / "kadr-output-test-XXXXXX").string();
        path_ = ::mkdtemp(name.data());
    }
    ~TemporaryFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;
    fs::path operator/(const fs::path& name) const { return path_ / name; }
    const fs::path& path() const { return path_; }
    std::vector<std::string> names() const {
        std::vector<std::string> found;
        for (const auto& entry : fs::directory_iterator(path_)) found.push_back(entry.path().filename());
        return found;
    }

private:
    fs::path path_;
};

/// Sets an environment variable for one test.
class ScopedVariable {
public:
    ScopedVariable(const char* name, const std::string& value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old, had_ = true;
        ::setenv(name, value.c_str(), 1);
    }
    ~ScopedVariable() { had_ ? ::setenv(name_, old_.c_str(), 1) : ::unsetenv(name_); }
    ScopedVariable(const ScopedVariable&) = delete;
    ScopedVariable& operator=(const ScopedVariable&) = delete;

private:
    const char* name_;
    std::string old_;
    bool had_ = false;
};

/// Every pixel the same.
inline Image plain_image(int width, int height, std::vector<std::string> channels, const std::vector<float>& pixel) {
    Image image{width, height, std::move(channels), {}};
    for (int i = 0; i < width * height; ++i)
        for (const float value : pixel) image.pixels.push_back(value);
    return image;
}

/// A gradient that differs in every pixel and from phase to phase.
inline Image gradient(int width, int height, int phase = 0) {
    Image image{width, height, {"R", "G", "B"}, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            image.pixels.push_back(static_cast<float>((x * 255 / width + 16 * phase) % 256) / 255);
            image.pixels.push_back(static_cast<float>(y * 255 / height) / 255);
            image.pixels.push_back(static_cast<float>((x * 7 + y * 13) % 256) / 255);
        }
    return image;
}

inline int channel(const Image& image, const std::string& name) {
    for (std::size_t i = 0; i < image.channels.size(); ++i)
        if (image.channels[i] == name) return static_cast<int>(i);
    return -1;
}

inline void write_text(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

/// The message of the exception that a call throws.
template <class Error, class Function>
std::string message_of(const Function& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return "(nothing thrown)";
}

}  // namespace kadr::test
