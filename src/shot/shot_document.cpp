#include "shot/shot_document.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <memory>

namespace kadr {

std::string read_document_file(const std::filesystem::path& path) {
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::error_code failed;
    if (!std::filesystem::exists(path, failed))
        throw InputError(fmt::format("'{}' does not exist", path.string()), "expected a shot file (YAML)");
    if (!std::filesystem::is_regular_file(path, failed))
        throw InputError(fmt::format("'{}' is not a file", path.string()), "expected a shot file (YAML)");
    const std::unique_ptr<std::FILE, Close> file(std::fopen(path.c_str(), "rb"));
    if (!file) throw InputError(fmt::format("'{}' cannot be read", path.string()), "check its permissions");
    std::string text(kMostYamlBytes + 1, '\0');
    text.resize(std::fread(text.data(), 1, text.size(), file.get()));
    return text;
}

YamlNode parse_root(const YamlSource& source, const char* minimal) {
    YamlNode root = parse_yaml(source);
    if (root.kind == YamlNode::Kind::null)
        throw InputError(diagnostic_at({&source, -1, 0, 0}, "the file is empty", minimal));
    if (!root.is_map())
        throw InputError(diagnostic_at(root.place, fmt::format("the file is {}", shown_value(root)), minimal));
    return root;
}

void check_duplicates(Problems& problems, const YamlNode& node) {
    std::map<std::string_view, const YamlEntry*> seen;
    for (const YamlEntry& entry : node.entries) {
        const auto [first, fresh] = seen.emplace(entry.key.text, &entry);
        if (!fresh) {
            const int line = location_of(first->second->key.place).line;  // an argument has none
            problems.error(entry.key.place, fmt::format("duplicate key '{}'", entry.key.text),
                           line > 0 ? fmt::format("it is already given at line {}; keep one of the two", line) : "it is given twice; keep one of the two");
        }
        check_duplicates(problems, entry.value);
    }
    for (const YamlNode& item : node.items) check_duplicates(problems, item);
}

std::string read_name(const Section& root, const std::filesystem::path& file) {
    const Field field = root["name"];
    const auto name = read_text(field);
    if (!name) return file.stem().string();
    const bool usable = name->find_first_of("/{}") == std::string::npos && *name != "." && *name != ".." &&
                        name->size() <= 100 && name->find_first_of(std::string_view("\n\r\t", 3)) == std::string::npos;
    if (usable) return *name;
    field.error(fmt::format("name is '{}'", *name),
                "expected a name that can be part of a file name: no '/', braces or line breaks, at most 100 bytes");
    return file.stem().string();
}

}  // namespace kadr
