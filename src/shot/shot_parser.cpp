#include "shot/shot_parser.h"

#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <memory>

#include "shot/overrides.h"
#include "shot/section_readers.h"

namespace kadr {

namespace {

/// Reads a file, but at most one byte more than a shot may have.
std::string read_text_file(const std::filesystem::path& path) {
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

/// yaml-cpp and YAML itself let a key stand twice; one of the two would silently win.
void check_duplicates(Problems& problems, const YamlNode& node) {
    std::map<std::string_view, const YamlEntry*> seen;
    for (const YamlEntry& entry : node.entries) {
        const auto [first, fresh] = seen.emplace(entry.key.text, &entry);
        if (!fresh)
            problems.error(entry.key.place, fmt::format("duplicate key '{}'", entry.key.text),
                           fmt::format("it is already given at line {}; keep one of the two",
                                       location_of(first->second->key.place).line));
        check_duplicates(problems, entry.value);
    }
    for (const YamlNode& item : node.items) check_duplicates(problems, item);
}

void check_version(const Section& root) {
    const auto version = read_integer(root["kadr"]);
    if (version && *version != 1)
        root["kadr"].error(fmt::format("the shot is written in format version {}", *version),
                           "expected kadr: 1; this Kadr reads version 1");
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

Shot read_shot(ReadContext& context, const YamlNode& root_node, const std::filesystem::path& file,
               const std::filesystem::path& working_folder) {
    const Section root(context, &root_node, "", "");
    Shot shot;
    shot.file = file;
    check_version(root);
    shot.name = context.name = read_name(root, file);
    const ReadTiming timing = read_timing(root);
    shot.timing = context.timing = timing.timing;
    shot.frames_given = timing.frames_given;
    shot.image = read_image(root);
    shot.scenes = read_scenes(root);
    shot.camera = read_camera(root);
    shot.shutter = read_shutter(root);
    shot.lights = read_lights(root);
    shot.environment = read_environment(root, !shot.lights.empty());
    assign(shot.use_scene_lights, read_boolean(root["use_scene_lights"]));
    shot.render = read_render(root);
    shot.view = read_view(root);
    // Without a range the clips decide, which are not read yet: frame/ knows whether there are several frames.
    const bool one_frame = !shot.frames_given || shot.timing.frames.size() == 1;
    shot.output = read_output(root, one_frame, working_folder);
    return shot;
}

[[noreturn]] void fail_at(const YamlPlace& place, std::string found, std::string expected) {
    throw InputError(diagnostic_at(place, std::move(found), std::move(expected)));
}

YamlNode parse_root(const YamlSource& source) {
    constexpr const char* kMinimal =
        "expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] }";
    YamlNode root = parse_yaml(source);
    if (root.kind == YamlNode::Kind::null) fail_at({&source, -1, 0, 0}, "the file is empty", kMinimal);
    if (!root.is_map()) fail_at(root.place, fmt::format("the file is {}", shown_value(root)), kMinimal);
    if (root.find("kadr-reel"))
        fail_at(root.entries.front().key.place, "this is a reel (kadr-reel), and reels are not supported yet",
                "render its shots one by one");
    return root;
}

}  // namespace

Shot parse_shot_text(std::string_view text, const std::filesystem::path& path, const ShotOverrides& overrides) {
    const std::filesystem::path working_folder = std::filesystem::current_path();
    const std::filesystem::path file = (working_folder / path).lexically_normal();
    YamlDocument document;
    const YamlSource& source = document.add_source(text, path.string(), file.parent_path(), false);
    document.root = parse_root(source);
    ReadContext context;
    check_duplicates(context.problems, document.root);
    const std::vector<Diagnostic> unusable = apply_overrides(document, overrides, working_folder);
    Shot shot = read_shot(context, document.root, file, working_folder);
    std::vector<Diagnostic> errors = context.problems.take_errors();
    errors.insert(errors.end(), unusable.begin(), unusable.end());
    if (!errors.empty()) throw InputError(std::move(errors));
    shot.warnings = context.problems.take_warnings();
    return shot;
}

Shot parse_shot(const std::filesystem::path& path, const ShotOverrides& overrides) {
    return parse_shot_text(read_text_file(path), path, overrides);
}

}  // namespace kadr
