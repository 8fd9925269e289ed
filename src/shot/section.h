#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "anim/timing.h"
#include "shot/schema.h"
#include "shot/track_limits.h"
#include "shot/yaml_document.h"

namespace kadr {

/// Problems of one document, in the order of its lines.
class Problems {
public:
    void error(const YamlPlace& place, std::string found, std::string expected = {});
    void warning(const YamlPlace& place, std::string found, std::string expected = {});
    bool any() const { return !errors_.empty(); }
    /// Whether so many were found that more would only cost time: from here on errors are counted, not kept.
    bool full() const;
    /// Errors sorted by place, cut after a hundred (the last then says how many are left).
    std::vector<Diagnostic> take_errors();
    std::vector<Diagnostic> take_warnings() { return std::move(warnings_); }

private:
    struct Error {
        YamlPlace place;
        Diagnostic diagnostic;
    };
    std::vector<Error> errors_;
    std::size_t not_kept_ = 0;
    std::vector<Diagnostic> warnings_;
};

/// What all readers of one document share.
struct ReadContext {
    Problems problems;
    Timing timing;     ///< read first: times in frames need its rate
    std::string name;  ///< of the shot
    std::vector<LimitedTrack> limited_tracks;
};

/// A value of the document, what the format says about it, and how messages call it.
struct Field {
    ReadContext* context = nullptr;
    const YamlNode* node = nullptr;  ///< null: absent
    const FieldSpec* spec = nullptr;
    std::string name;  ///< "lights.key.intensity"

    explicit operator bool() const { return node != nullptr; }
    /// Another value that the same row describes: a component, a key's value.
    Field with(const YamlNode& other, std::string other_name) const {
        return {context, &other, spec, std::move(other_name)};
    }
    void error(std::string found, std::string expected) const {
        context->problems.error(node->place, std::move(found), std::move(expected));
    }
    /// "<name> is <value>", "expected <what the row says>; <hint>"
    void mismatch(std::string_view advice = {}) const;
    /// The same with another expectation.
    void mismatch_with(std::string expected, std::string_view advice = {}) const;
};

/// A value as messages show it: 540 deg, 'many', a list, a map, empty.
std::string shown_value(const YamlNode& node);

/// A map of the document. Its constructor reports keys the format does not have, keys that are not built yet and
/// required keys that are missing.
class Section {
public:
    /// @param node  null or a null node: the section is absent and every field of it too
    /// @param schema_path  where its keys stand in the table ("lights"); @param name how messages call it
    /// ("lights.key")
    Section(ReadContext& context, const YamlNode* node, std::string schema_path, std::string name);
    /// Section under a key of this one; absent when the value is not a map (which is reported unless the row has
    /// other forms).
    Section section(std::string_view key) const;
    Field operator[](std::string_view key) const;
    bool has(std::string_view key) const { return static_cast<bool>((*this)[key]); }
    /// Reports two keys that exclude each other, at the second. @return whether both are there
    bool exclusive(std::string_view one, std::string_view other) const;
    bool present() const { return node_ != nullptr; }
    ReadContext& context() const { return *context_; }
    const YamlNode* node() const { return node_; }
    const std::string& name() const { return name_; }
    /// Place of a key itself. @pre the key is there
    YamlPlace key_place(std::string_view key) const;

private:
    std::string path_of(std::string_view key) const {
        return schema_path_.empty() ? std::string(key) : schema_path_ + "." + std::string(key);
    }
    std::string name_of(std::string_view key) const {
        return name_.empty() ? std::string(key) : name_ + "." + std::string(key);
    }
    void check_keys() const;
    void check_key(const YamlEntry& entry) const;
    void unknown_key(const YamlEntry& entry) const;
    void check_required() const;

    ReadContext* context_;
    const YamlNode* node_;
    std::string schema_path_, name_;
};

// Readers: nothing for an absent field, and nothing after reporting what is wrong with a present one.
std::optional<double> read_number(const Field& field);
std::optional<std::int64_t> read_integer(const Field& field);
std::optional<bool> read_boolean(const Field& field);
std::optional<std::string> read_text(const Field& field);
std::optional<glm::dvec2> read_vector2(const Field& field);
std::optional<glm::dvec3> read_vector3(const Field& field);
/// Absolute path; relative ones start at the folder of the text that names them.
std::optional<std::filesystem::path> read_path(const Field& field);
/// Path of a file that must exist and end in one of the endings (".glb"); any ending when there are none.
std::optional<std::filesystem::path> read_existing_file(const Field& field, const std::vector<std::string>& endings);
/// Index of the word among the row's choices.
std::optional<int> read_choice_index(const Field& field);

/// The enum whose values stand in the order of the row's choices.
template <class Enum>
std::optional<Enum> read_choice(const Field& field) {
    const std::optional<int> index = read_choice_index(field);
    return index ? std::optional(static_cast<Enum>(*index)) : std::nullopt;
}

/// Whether the value is the unquoted word.
bool is_word(const Field& field, std::string_view word);
/// Whether a scalar looks like a number: an optional sign, then a digit or a dot.
bool looks_like_number(const YamlNode& node);

template <class T, class Value>
void assign(T& target, const std::optional<Value>& value) {
    if (value) target = static_cast<T>(*value);
}

}  // namespace kadr
