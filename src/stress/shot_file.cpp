#include "stress/shot_file.h"

#include <cmath>

#include <fmt/format.h>

#include "base/text.h"
#include "stress/file.h"
#include "stress/sun_image.h"

namespace kadr::stress {

namespace {

std::string list_of(const std::vector<double>& values) {
    std::string text;
    for (const double value : values) text += (text.empty() ? "" : ", ") + format_number(value);
    return "[" + text + "]";
}
std::string list_of(const glm::dvec3& v) { return list_of(std::vector{v.x, v.y, v.z}); }

std::string keys_of(const std::vector<MotionKey>& keys, std::string_view unit) {
    std::string text;
    for (const MotionKey& key : keys) {
        const std::string value = key.value.size() == 1 ? format_number(key.value[0]) + std::string(unit) : list_of(key.value);
        text += fmt::format("{}{} s: {}", text.empty() ? "" : ", ", format_number(key.time_s), value);
    }
    return "{ keys: { " + text + " } }";
}

std::string motion_of(const Motion& motion) {
    std::string text;
    const auto add = [&](std::string_view key, const std::string& value) { text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", key, value); };
    if (!motion.translate.empty()) add("translate", keys_of(motion.translate, ""));
    if (!motion.rotate.empty()) add("rotate", keys_of(motion.rotate, ""));
    if (!motion.angle.empty()) add("rotate", "{ axis: [0, 0, 1], angle: " + keys_of(motion.angle, " deg") + " }");
    if (!motion.scale.empty()) add("scale", keys_of(motion.scale, ""));
    return "{ " + text + " }";
}

std::string nodes_of(const Stage& stage) {
    std::string text;
    for (const Object& object : stage.objects)
        if (!object.motion.none() && !object.motion.in_clip) text += fmt::format("{}{}: {}", text.empty() ? "" : ", ", object.name, motion_of(object.motion));
    return text.empty() ? "" : ", nodes: { " + text + " }";
}

class ShotText {
public:
    explicit ShotText(const Stage& stage) : stage_(stage), scale_(stage.world.scale * stage.vertices.scale) {}

    std::string text() const {
        return fmt::format("kadr: 1\nname: {}\ntiming: {{ fps: {}, frames: {} }}\nimage: {{ size: [{}, {}] }}\n"
                           "scenes: [ {{ id: stage, gltf: {}.gltf{} }} ]\n{}\nshutter: {}\nlights: [ {} ]\nenvironment: {}\n"
                           "render: {{ samples: {} }}\nview: {{ exposure: {} }}\n",
                           stage_.name, stage_.fps, stage_.frame, stage_.width, stage_.height, stage_.name, nodes_of(stage_), camera(), shutter(), light(), environment(),
                           stage_.samples, format_number(stage_.exposure_stops));
    }

private:
    glm::dvec3 placed(const glm::dvec3& p) const { return stage_.world.of(stage_.vertices.of(p)); }
    std::string length(double metres) const { return format_number(scale_ * metres); }

    std::string camera() const {
        const Camera& camera = stage_.camera;
        if (camera.authored) return "camera: { gltf: stage/Camera }";
        return fmt::format("camera: {{ position: {}, look_at: {}, vertical_fov: {} deg }}", list_of(placed(camera.position)), list_of(placed(camera.look_at)),
                           format_number(camera.vertical_fov_deg));
    }

    std::string shutter() const { return stage_.shutter_s > 0 ? fmt::format("{{ time: {} s }}", format_number(stage_.shutter_s)) : "0"; }

    std::string light() const {
        const Lamp& lamp = stage_.key;
        const double area = scale_ * scale_;  // what falls on a surface that grows along stays the same
        if (lamp.strength == 0) return "";
        const std::string place = fmt::format("position: {}", list_of(placed(lamp.position)));
        const std::string aim = fmt::format("direction: {}", list_of(lamp.target - lamp.position));
        const std::string extent = (lamp.range_m > 0 ? ", range: " + length(lamp.range_m) : "") + (lamp.radius_m > 0 ? ", radius: " + length(lamp.radius_m) : "");
        switch (lamp.kind) {
            case LightKind::directional:
                return fmt::format("{{ id: key, type: directional, illuminance: {}, {}, angular_diameter: {} deg }}", format_number(lamp.strength), aim, format_number(lamp.diameter_deg));
            case LightKind::point: return fmt::format("{{ id: key, type: point, intensity: {}, {}{} }}", format_number(area * lamp.strength), place, extent);
            case LightKind::spot:
                return fmt::format("{{ id: key, type: spot, intensity: {}, {}, {}, inner: {} deg, outer: {} deg{} }}", format_number(area * lamp.strength), place, aim,
                                   format_number(lamp.inner_deg), format_number(lamp.outer_deg), extent);
            default: return fmt::format("{{ id: key, type: area, luminance: {}, {}, {}, size: [{}, {}] }}", format_number(lamp.strength), place, aim, length(lamp.side_m), length(lamp.side_m));
        }
    }

    std::string environment() const {
        if (stage_.sky_sun > 0) return fmt::format("{{ image: {}.hdr }}", stage_.name);
        return fmt::format("{{ color: [1, 1, 1], strength: {} }}", format_number(stage_.sky));
    }

    const Stage& stage_;
    const double scale_;  ///< of everything
};

}  // namespace

std::filesystem::path write_shot_file(const Stage& stage, const std::filesystem::path& folder) {
    if (stage.sky_sun > 0) write_sun_image(folder / (stage.name + ".hdr"), stage.sky, stage.sky_sun);
    const std::string text = ShotText(stage).text();
    const std::filesystem::path file = folder / (stage.name + ".yaml");
    write_file(file, text);
    return file;
}

}  // namespace kadr::stress
