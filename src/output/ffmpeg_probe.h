#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace kadr {

/// What the installed ffmpeg can do. Asked once per ffmpeg (path, size and time of the file) and kept in a file of the
/// cache folder: KADR_CACHE, else XDG_CACHE_HOME/kadr, else ~/.cache/kadr. Without a writable cache it is asked each time.
class FfmpegProbe {
public:
    /// @throws RenderError  when the program cannot be run
    explicit FfmpegProbe(std::filesystem::path program);
    const std::filesystem::path& program() const { return program_; }
    bool has_encoder(const std::string& encoder) const;
    /// Pixel formats of an encoder; empty when ffmpeg does not list any.
    std::vector<std::string> pixel_formats(const std::string& encoder);

private:
    const std::vector<std::string>* find(const std::string& topic) const;
    void load();
    void save() const;

    std::filesystem::path program_;
    std::filesystem::path cache_file_;   ///< empty: none
    std::string identity_;
    /// "encoders" and "pixel_formats ENCODER", each with its names.
    std::vector<std::pair<std::string, std::vector<std::string>>> topics_;
};

}  // namespace kadr
