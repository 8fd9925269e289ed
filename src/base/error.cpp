#include "base/error.h"

#include <fmt/format.h>

#include <filesystem>
#include <string_view>

namespace kadr {

namespace {

constexpr std::string_view kExcerptIndent = "    ";
constexpr std::size_t kLongestExcerpt = 160;  // characters; longer lines are shown around the caret
constexpr std::size_t kContextBeforeCaret = 60;

/// A file below the working folder is shown relative to it: what the user typed, and what editors can follow.
std::string shown_path(const std::string& file) {
    const std::filesystem::path path(file);
    if (!path.is_absolute()) return file;
    std::error_code failed;
    const std::filesystem::path folder = std::filesystem::current_path(failed);
    if (failed) return file;
    const std::filesystem::path relative = path.lexically_normal().lexically_relative(folder);
    return relative.empty() || *relative.begin() == ".." ? file : relative.string();
}

std::string place_of(const SourceLocation& where) {
    if (where.file.empty()) return {};
    std::string place = shown_path(where.file);
    if (where.line > 0) place += fmt::format(":{}", where.line);
    if (where.line > 0 && where.column > 0) place += fmt::format(":{}", where.column);
    return place + ": ";
}

bool continues_character(char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; }

/// Characters of UTF-8 text, each as its bytes: columns count characters, and a terminal shows one cell for most.
std::vector<std::string_view> characters(std::string_view line) {
    std::vector<std::string_view> result;
    for (std::size_t begin = 0; begin < line.size();) {
        std::size_t end = begin + 1;
        while (end < line.size() && continues_character(line[end])) ++end;
        result.push_back(line.substr(begin, end - begin));
        begin = end;
    }
    return result;
}

/// The excerpt and the line below it with the caret; both end with a newline.
std::string excerpt_of(const Diagnostic& diagnostic) {
    const auto all = characters(diagnostic.excerpt);
    const std::size_t caret = diagnostic.where.column > 0 ? static_cast<std::size_t>(diagnostic.where.column - 1) : 0;
    const bool cut = all.size() > kLongestExcerpt;
    const std::size_t first = cut && caret > kContextBeforeCaret ? caret - kContextBeforeCaret : 0;
    const std::size_t last = cut ? std::min(all.size(), first + kLongestExcerpt) : all.size();
    const std::string_view before = first > 0 ? "..." : "";
    std::string shown{before};
    std::string under(before.size(), ' ');
    for (std::size_t i = first; i < last; ++i) {
        shown += all[i];
        if (i < caret)
            under += all[i] == "\t" ? "\t" : " ";  // a tab stays one, so that the caret stays below its column
    }
    if (last < all.size()) shown += "...";
    if (diagnostic.where.column <= 0) return fmt::format("{}{}\n", kExcerptIndent, shown);
    const std::size_t room = last > caret ? last - caret : 1;
    const std::size_t length = std::min(room, static_cast<std::size_t>(std::max(diagnostic.excerpt_length, 1)));
    return fmt::format("{0}{1}\n{0}{2}^{3}\n", kExcerptIndent, shown, under, std::string(length - 1, '~'));
}

std::string joined(const std::vector<Diagnostic>& diagnostics) {
    std::string text;
    for (const Diagnostic& diagnostic : diagnostics) {
        if (!text.empty()) text += '\n';
        text += diagnostic.text();
    }
    return text;
}

}  // namespace

std::string Diagnostic::text() const {
    std::string message = fmt::format("{}{}: {}\n", place_of(where), warning ? "warning" : "error", found);
    if (!excerpt.empty()) message += excerpt_of(*this);
    if (!expected.empty()) message += fmt::format("  {}\n", expected);
    message.pop_back();
    return message;
}

InputError::InputError(std::vector<Diagnostic> diagnostics)
    : std::runtime_error(joined(diagnostics)), diagnostics_(std::move(diagnostics)) {}

InputError::InputError(Diagnostic diagnostic) : InputError(std::vector<Diagnostic>{std::move(diagnostic)}) {}

InputError::InputError(std::string found, std::string expected)
    : InputError(Diagnostic{{}, std::move(found), {}, 1, std::move(expected), false}) {}

}  // namespace kadr
