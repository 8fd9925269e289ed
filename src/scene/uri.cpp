#include "scene/uri.h"

#include <array>
#include <cctype>
#include <filesystem>

namespace kadr {

namespace {

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

constexpr std::array<std::int8_t, 256> base64_values() {
    std::array<std::int8_t, 256> values{};
    values.fill(-1);
    for (int i = 0; i < 26; ++i) {
        values[static_cast<std::size_t>('A' + i)] = static_cast<std::int8_t>(i);
        values[static_cast<std::size_t>('a' + i)] = static_cast<std::int8_t>(26 + i);
    }
    for (int i = 0; i < 10; ++i) values[static_cast<std::size_t>('0' + i)] = static_cast<std::int8_t>(52 + i);
    values['+'] = values['-'] = 62;
    values['/'] = values['_'] = 63;
    return values;
}

std::optional<std::vector<std::uint8_t>> decode_base64(std::string_view text) {
    static constexpr auto kValues = base64_values();
    while (!text.empty() && text.back() == '=') text.remove_suffix(1);
    if (text.size() % 4 == 1) return std::nullopt;
    std::vector<std::uint8_t> bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int value = kValues[static_cast<unsigned char>(c)];
        if (value < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(value);
        count += 6;
        if (count >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
    }
    return bytes;
}

bool has_scheme(std::string_view path) {
    const std::size_t colon = path.find(':');
    if (colon == std::string_view::npos || colon == 0 || path.find('/') < colon) return false;
    for (const char c : path.substr(0, colon))
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '+' && c != '-' && c != '.') return false;
    return true;
}

}  // namespace

std::string percent_decode(std::string_view text) {
    std::string result;
    result.reserve(text.size());
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool coded = text[i] == '%' && i + 2 < text.size() && hex_digit(text[i + 1]) >= 0 && hex_digit(text[i + 2]) >= 0;
        if (!coded) {
            result += text[i];
            continue;
        }
        result += static_cast<char>(hex_digit(text[i + 1]) * 16 + hex_digit(text[i + 2]));
        i += 2;
    }
    return result;
}

std::optional<std::vector<std::uint8_t>> decode_data_uri(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (uri.substr(0, 5) != "data:" || comma == std::string_view::npos) return std::nullopt;
    const std::string_view header = uri.substr(5, comma - 5), body = uri.substr(comma + 1);
    constexpr std::string_view kBase64 = ";base64";
    if (header.size() >= kBase64.size() && header.substr(header.size() - kBase64.size()) == kBase64) return decode_base64(body);
    const std::string text = percent_decode(body);
    return std::vector<std::uint8_t>(text.begin(), text.end());
}

std::optional<std::string> path_within_folder(std::string_view uri) {
    const std::string decoded = percent_decode(uri);
    if (decoded.empty() || has_scheme(uri) || decoded.find('\0') != std::string::npos) return std::nullopt;
    const std::filesystem::path path = std::filesystem::path(decoded).lexically_normal();
    if (path.is_absolute() || path.empty() || *path.begin() == "..") return std::nullopt;
    return path.string();
}

}  // namespace kadr
