#include <fmt/format.h>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// What an authored camera brings itself.
constexpr const char* kAuthored[] = {"position", "look_at", "up", "focal_length", "vertical_fov", "sensor"};

std::optional<std::variant<Track<double>, NodeReference>> read_focus(const Field& field) {
    using Focus = std::variant<Track<double>, NodeReference>;
    if (!field) return std::nullopt;
    if (field.node->is_scalar() && !looks_like_number(*field.node)) {
        const auto node = read_node(field);
        return node ? std::optional<Focus>(*node) : std::nullopt;
    }
    auto distance = read_number_track(field);
    return distance ? std::optional<Focus>(std::move(*distance)) : std::nullopt;
}

void read_blades(const Field& field, CameraSpec& camera) {
    const auto blades = read_integer(field);
    if (blades && (*blades == 1 || *blades == 2))
        return field.error(fmt::format("{} is {}", field.name, *blades), "expected 0 for a round aperture, or 3 to 32");
    assign(camera.blades, blades);
}

void read_sensor(const Section& section, CameraSpec& camera) {
    const Section sensor = section.section("sensor");
    assign(camera.sensor_mm, read_vector2(sensor["size"]));
    assign(camera.fit, read_choice<CameraSpec::Fit>(sensor["fit"]));
}

}  // namespace

CameraSpec read_camera(const Section& shot) {
    CameraSpec camera;
    const Section section = shot.section("camera");
    if (!section.present()) return camera;
    camera.where = location_of(shot.key_place("camera"));
    camera.gltf = read_node(section["gltf"]);
    for (const char* key : kAuthored) section.exclusive("gltf", key);
    section.exclusive("focal_length", "vertical_fov");
    assign(camera.position, read_vector3_track(section["position"]));
    assign(camera.look_at, read_target(section["look_at"]));
    assign(camera.up, read_direction_track(section["up"]));
    camera.focal_length_mm = read_number_track(section["focal_length"]);
    camera.vertical_fov_rad = read_number_track(section["vertical_fov"]);
    read_sensor(section, camera);
    camera.f_stop = read_number_track(section["f_stop"]);
    camera.focus = read_focus(section["focus"]);
    read_blades(section["blades"], camera);
    return camera;
}

}  // namespace kadr
