#include "shot/shot_parser.h"

#include <fmt/format.h>

#include "shot/overrides.h"
#include "shot/section_readers.h"
#include "shot/shot_document.h"

namespace kadr {

namespace {

void check_version(const Section& root) {
    const auto version = read_integer(root["kadr"]);
    if (version && *version != 1)
        root["kadr"].error(fmt::format("the shot is written in format version {}", *version),
                           "expected kadr: 1; this Kadr reads version 1");
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

constexpr const char* kMinimal =
    "expected a shot, at least: kadr: 1, scenes: [ { gltf: model.glb } ], camera: { position: [0, 1, 5] }";

void refuse_reel(const YamlNode& root) {
    const YamlNode* reel = root.find("kadr-reel");
    if (!reel) return;
    throw InputError(diagnostic_at(reel->place, "this is a reel (kadr-reel), not a shot",
                                   "expected a shot file here; `kadr render` and `kadr check` take reels, too"));
}

}  // namespace

Shot parse_shot_text(std::string_view text, const std::filesystem::path& path, const ShotOverrides& overrides) {
    const std::filesystem::path working_folder = std::filesystem::current_path();
    const std::filesystem::path file = (working_folder / path).lexically_normal();
    YamlDocument document;
    const YamlSource& source = document.add_source(text, path.string(), file.parent_path(), false);
    document.root = parse_root(source, kMinimal);
    refuse_reel(document.root);
    ReadContext context;
    check_duplicates(context.problems, document.root);
    const std::vector<Diagnostic> unusable = apply_overrides(document, overrides, working_folder);
    Shot shot = read_shot(context, document.root, file, working_folder);
    std::vector<Diagnostic> errors = context.problems.take_errors();
    errors.insert(errors.end(), unusable.begin(), unusable.end());
    if (!errors.empty()) throw InputError(std::move(errors));
    shot.warnings = context.problems.take_warnings();
    shot.limited_tracks = std::move(context.limited_tracks);
    return shot;
}

Shot parse_shot(const std::filesystem::path& path, const ShotOverrides& overrides) {
    return parse_shot_text(read_document_file(path), path, overrides);
}

}  // namespace kadr
