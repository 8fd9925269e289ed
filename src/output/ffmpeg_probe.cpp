#include "output/ffmpeg_probe.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <sstream>

#include "base/cache_folder.h"
#include "base/error.h"
#include "base/hash.h"
#include "output/atomic_file.h"
#include "output/child_process.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

// First line of a cache file; a new number makes old files unread.
constexpr const char* kCacheFormat = "kadr ffmpeg probe 2";
constexpr const char* kEncoders = "encoders";

std::string identity_of(const fs::path& program) {
    struct stat status {};
    if (::stat(program.c_str(), &status) != 0) return {};
    return fmt::format("{} {} {}.{:09}", program.string(), status.st_size, status.st_mtim.tv_sec, status.st_mtim.tv_nsec);
}

std::vector<std::string> words_of(const std::string& line) {
    std::istringstream stream(line);
    std::vector<std::string> words;
    for (std::string word; stream >> word;) words.push_back(word);
    return words;
}

/// The second word of lines such as " V....D libx264  H.264 ...", of video and sound; those above the line of dashes explain the letters.
std::vector<std::string> parse_encoders(const std::string& text) {
    std::vector<std::string> names;
    std::istringstream lines(text);
    bool listing = false;
    for (std::string line; std::getline(lines, line);) {
        const std::vector<std::string> words = words_of(line);
        const bool wanted = listing && words.size() >= 2 && (words[0].starts_with('V') || words[0].starts_with('A'));
        if (wanted) names.push_back(words[1]);
        if (words.size() == 1 && words[0].starts_with("---")) listing = true;
    }
    return names;
}

std::vector<std::string> parse_pixel_formats(const std::string& text) {
    constexpr std::string_view kLabel = "Supported pixel formats:";
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);)
        if (const std::size_t at = line.find(kLabel); at != std::string::npos) return words_of(line.substr(at + kLabel.size()));
    return {};
}

std::string ask(const fs::path& program, const Arguments& question) {
    Arguments arguments{program.string(), "-hide_banner"};
    arguments.insert(arguments.end(), question.begin(), question.end());
    const ProgramResult result = run_program(arguments);
    if (result.status == 0) return result.output;
    throw RenderError(fmt::format("'{}' does not work: it ended with status {} when asked for its encoders{}{}", program.string(),
                                  result.status, result.error_tail.empty() ? "" : "\n", result.error_tail));
}

}  // namespace

FfmpegProbe::FfmpegProbe(fs::path program) : program_(std::move(program)), identity_(identity_of(program_)) {
    if (const auto folder = cache_folder()) {
        Hasher hasher;
        hasher.add(program_.string());
        cache_file_ = *folder / fmt::format("ffmpeg-{}.txt", hasher.finish().hex());
    }
    load();
    if (find(kEncoders)) return;
    topics_.emplace_back(kEncoders, parse_encoders(ask(program_, {"-encoders"})));
    save();
}

bool FfmpegProbe::has_encoder(const std::string& encoder) const {
    const std::vector<std::string>* encoders = find(kEncoders);
    return encoders && std::find(encoders->begin(), encoders->end(), encoder) != encoders->end();
}

std::vector<std::string> FfmpegProbe::pixel_formats(const std::string& encoder) {
    const std::string topic = "pixel_formats-" + encoder;
    if (const auto* known = find(topic)) return *known;
    topics_.emplace_back(topic, parse_pixel_formats(ask(program_, {"-h", "encoder=" + encoder})));
    save();
    return topics_.back().second;
}

const std::vector<std::string>* FfmpegProbe::find(const std::string& topic) const {
    for (const auto& [name, values] : topics_)
        if (name == topic) return &values;
    return nullptr;
}

void FfmpegProbe::load() {
    if (cache_file_.empty() || identity_.empty()) return;
    std::ifstream file(cache_file_);
    std::string line;
    if (!std::getline(file, line) || line != kCacheFormat) return;
    if (!std::getline(file, line) || line != identity_) return;
    while (std::getline(file, line)) {
        std::vector<std::string> words = words_of(line);
        if (words.empty()) continue;
        const std::string topic = words.front();
        words.erase(words.begin());
        topics_.emplace_back(topic, std::move(words));
    }
}

void FfmpegProbe::save() const {
    if (cache_file_.empty() || identity_.empty()) return;
    std::string text = fmt::format("{}\n{}\n", kCacheFormat, identity_);
    for (const auto& [topic, values] : topics_) text += fmt::format("{} {}\n", topic, fmt::join(values, " "));
    try {
        create_folder_of(cache_file_);
        write_atomically(cache_file_, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    } catch (const RenderError&) {
        // No cache, then: the next run asks again, which costs a tenth of a second.
    }
}

}  // namespace kadr
