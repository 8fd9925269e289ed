#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kadr {

/// The candidate nearest to `word` by edit distance (Damerau-Levenshtein, adjacent swaps count one), or nothing
/// when even the nearest differs in more than a third of its letters (at least one edit is always allowed).
std::optional<std::string> nearest_name(std::string_view word, std::span<const std::string> candidates);

/// Shortest decimal text that reads back as the same double ("0.1", "24", "1e+20").
std::string format_number(double value);

/// Whether the bytes are valid UTF-8 (no overlong forms, no surrogates); the offset of the first bad byte otherwise.
std::optional<std::size_t> first_invalid_utf8(std::string_view bytes);

}  // namespace kadr
