#include "measure/frame_sequence.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <regex>
#include <set>
#include <tuple>

#include <fmt/format.h>

#include "base/error.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExpected =
    "expected an image (.exr, .png, .jpg), a folder of images, a pattern such as out/pan.{frame:04}.exr, or a shot";

std::string lower(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool is_image_name(const fs::path& path) {
    static const std::set<std::string> kEndings{".exr", ".png", ".jpg", ".jpeg"};
    return path.filename().string().front() != '.' && kEndings.contains(lower(path.extension().string()));
}

/// Where the last run of digits of a name without its ending is.
FrameFile described(const fs::path& path) {
    static const std::regex kLastNumber(R"(^(.*?)(-?[0-9]{1,9})([^0-9]*)$)");
    FrameFile frame{path, path.filename().string(), std::nullopt};
    std::smatch match;
    const std::string stem = path.stem().string();
    if (!std::regex_match(stem, match, kLastNumber)) return frame;
    frame.series = match[1].str() + "#" + match[3].str() + path.extension().string();
    frame.number = std::stoi(match[2]);
    return frame;
}

void sort(std::vector<FrameFile>& files) {
    std::sort(files.begin(), files.end(), [](const FrameFile& a, const FrameFile& b) {
        return std::tie(a.series, a.number, a.file) < std::tie(b.series, b.number, b.file);
    });
}

const std::regex& number_fields() {
    static const std::regex fields(R"(\{frame(:0?[0-9]{1,2})?\}|%(0[0-9])?d|#+)");
    return fields;
}

std::string escaped(const std::string& text) {
    static const std::regex kSpecial(R"([.^$|()\[\]{}*+?\\])");
    return std::regex_replace(text, kSpecial, R"(\$&)");
}

/// A pattern's file name as an expression whose group is the number.
std::regex expression_of(const std::string& name, const std::string& text) {
    const std::sregex_iterator first(name.begin(), name.end(), number_fields()), end;
    if (std::distance(first, end) != 1)
        throw InputError(fmt::format("the pattern '{}' has {} places for the frame's number in its last part", text,
                                     std::distance(first, end)),
                         "expected one: {frame:04}, %04d or ####");
    return std::regex(escaped(first->prefix()) + "(-?[0-9]{1,9})" + escaped(first->suffix()));
}

std::vector<fs::path> entries_of(const fs::path& folder) {
    std::error_code error;
    std::vector<fs::path> paths;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error))
        if (entry->is_regular_file()) paths.push_back(entry->path());
    if (error) throw InputError(fmt::format("cannot list the folder '{}': {}", folder.string(), error.message()));
    return paths;
}

FrameSequence frames_of_pattern(const std::string& text) {
    const fs::path pattern(text);
    const std::regex expression = expression_of(pattern.filename().string(), text);
    const fs::path folder = pattern.has_parent_path() ? pattern.parent_path() : fs::path(".");
    FrameSequence found{text, {}, false};
    for (const fs::path& path : entries_of(folder)) {
        const std::string name = path.filename().string();
        std::smatch match;
        if (std::regex_match(name, match, expression))
            found.files.push_back({path, pattern.filename().string(), std::stoi(match[1])});
    }
    if (found.files.empty()) throw InputError(fmt::format("no file matches '{}'", text), kExpected);
    sort(found.files);
    return found;
}

FrameSequence frames_of_folder(const std::string& text) {
    std::vector<fs::path> images;
    for (const fs::path& path : entries_of(text))
        if (is_image_name(path)) images.push_back(path);
    if (images.empty())
        throw InputError(fmt::format("there is no image in the folder '{}'", text),
                         "expected .exr, .png or .jpg files");
    return sequence_of(text, images);
}

/// Whether all files are numbered frames of one series.
bool is_one_series(const FrameSequence& sequence) {
    const FrameFile& first = sequence.files.front();
    return std::all_of(sequence.files.begin(), sequence.files.end(),
                       [&](const FrameFile& file) { return file.number && file.series == first.series; });
}

using Key = std::pair<int, std::string>;  ///< a number, or a name
using Keyed = std::map<Key, const FrameFile*>;

Keyed keyed(const FrameSequence& sequence, bool by_number, const std::set<int>& wanted) {
    Keyed result;
    for (const FrameFile& file : sequence.files) {
        if (!wanted.empty() && !(file.number && wanted.contains(*file.number))) continue;
        const Key key = by_number ? Key{*file.number, ""} : Key{0, file.file.stem().string()};
        const auto [at, is_new] = result.emplace(key, &file);
        if (!is_new)
            throw InputError(
                fmt::format("'{}' and '{}' are the same frame", at->second->file.string(), file.file.string()),
                "expected one image a frame: name them by a pattern, as in out/pan.{frame:04}.exr");
    }
    return result;
}

/// "frames 3, 4, 9 and 12 more"
std::string listed(const std::vector<std::string>& labels) {
    constexpr std::size_t kMost = 8;
    const std::size_t shown = std::min(kMost, labels.size());
    std::string text =
        fmt::format("{}", fmt::join(labels.begin(), labels.begin() + static_cast<std::ptrdiff_t>(shown), ", "));
    return labels.size() > shown ? fmt::format("{} and {} more", text, labels.size() - shown) : text;
}

std::string label_of(const Key& key) { return key.second.empty() ? std::to_string(key.first) : key.second; }

std::vector<std::string> missing_in(const Keyed& other, const Keyed& from) {
    std::vector<std::string> labels;
    for (const auto& [key, file] : from)
        if (!other.contains(key)) labels.push_back(label_of(key));
    return labels;
}

void refuse_partnerless(const FrameSequence& reference, const FrameSequence& test, const Keyed& a, const Keyed& b) {
    std::vector<Diagnostic> problems;
    const auto complain = [&](const FrameSequence& where, const std::vector<std::string>& labels) {
        if (labels.empty()) return;
        Diagnostic problem;
        problem.found = fmt::format("'{}' lacks frame{} {}", where.text, labels.size() == 1 ? "" : "s", listed(labels));
        problem.expected = "expected the frames of the other side; --frames 0-23 compares some of them";
        problems.push_back(problem);
    };
    complain(reference, missing_in(a, b));
    complain(test, missing_in(b, a));
    if (!problems.empty()) throw InputError(problems);
}

void refuse_missing_numbers(const std::vector<int>& frames, const Keyed& found, const FrameSequence& reference,
                            const FrameSequence& test) {
    std::set<int> numbers;
    for (const auto& [key, file] : found) numbers.insert(file->number.value_or(0));
    std::vector<std::string> missing;
    for (const int frame : frames)
        if (!numbers.contains(frame)) missing.push_back(std::to_string(frame));
    if (missing.empty()) return;
    throw InputError(fmt::format("neither '{}' nor '{}' has frame{} {}", reference.text, test.text,
                                 missing.size() == 1 ? "" : "s", listed(missing)),
                     "expected the numbers of images that are there after --frames");
}

}  // namespace

FrameSequence sequence_of(std::string text, const std::vector<fs::path>& files) {
    FrameSequence sequence{std::move(text), {}, false};
    for (const fs::path& path : files) sequence.files.push_back(described(path));
    sort(sequence.files);
    return sequence;
}

FrameSequence find_frames(const std::string& text) {
    std::error_code none;
    if (fs::is_directory(text, none)) return frames_of_folder(text);
    if (fs::is_regular_file(text, none)) {
        if (!is_image_name(text)) throw InputError(fmt::format("'{}' is not an image", text), kExpected);
        FrameSequence one = sequence_of(text, {fs::path(text)});
        one.single = true;
        return one;
    }
    if (std::regex_search(text, number_fields())) return frames_of_pattern(text);
    throw InputError(fmt::format("there is no file or folder '{}'", text), kExpected);
}

std::vector<FramePair> pair_frames(const FrameSequence& reference, const FrameSequence& test,
                                   const std::vector<int>& frames) {
    const auto file_name = [](const FrameSequence& side) { return side.files.front().file.filename().string(); };
    if (reference.single && test.single)
        return {{file_name(test), std::nullopt, reference.files.front().file, test.files.front().file}};
    if (reference.single != test.single)
        throw InputError(
            fmt::format("'{}' is one image and '{}' a sequence", (reference.single ? reference : test).text,
                        (reference.single ? test : reference).text),
            "expected two images or two sequences");
    const bool by_number = is_one_series(reference) && is_one_series(test);
    const std::set<int> wanted(frames.begin(), frames.end());
    const Keyed a = keyed(reference, by_number, wanted), b = keyed(test, by_number, wanted);
    refuse_partnerless(reference, test, a, b);
    refuse_missing_numbers(frames, a, reference, test);
    std::vector<FramePair> pairs;
    for (const auto& [key, file] : a) pairs.push_back({label_of(key), file->number, file->file, b.at(key)->file});
    return pairs;
}

}  // namespace kadr
