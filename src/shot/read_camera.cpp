#include <fmt/format.h>

#include "shot/section_readers.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

/// What an authored camera brings itself.
constexpr const char* kAuthored[] = {"position", "orbit", "look_at", "up", "focal_length", "vertical_fov", "sensor"};

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

/// What an orbit goes around and what the camera looks at are the same unless both are given.
void share_middle(const Section& section, const Field& around, CameraSpec& camera) {
    OrbitMotion& orbit = *camera.position.orbit;
    if (around && !section.has("look_at")) {
        camera.look_at = camera.around ? Target(*camera.around) : Target(PositionTrack(orbit.around));
    } else if (!around) {
        if (const auto* node = std::get_if<NodeReference>(&camera.look_at)) camera.around = *node;
        const auto* point = std::get_if<PositionTrack>(&camera.look_at);
        if (point && (point->path || point->orbit))
            section["orbit"].error("camera.orbit.around is missing, and camera.look_at travels", "add `around: [x, y, z]`");
        else if (point)
            orbit.around = point->keyed;
    }
}

/// Position and target: a point each, or a path to look along, or an orbit.
void read_place(const Section& section, CameraSpec& camera) {
    section.exclusive("position", "orbit");
    assign(camera.look_at, read_target(section["look_at"]));
    assign(camera.position, read_position_track(section["position"], true));
    if (const Field orbit = section["orbit"]) {
        camera.position.orbit = read_orbit(orbit, &camera.around);
        const YamlNode* around = orbit.node->is_map() ? orbit.node->find("around") : nullptr;
        if (camera.position.orbit) share_middle(section, {orbit.context, around, orbit.spec, orbit.name}, camera);
    }
    if (!camera.position.turns_along()) return;
    if (const Field look_at = section["look_at"])
        look_at.error("camera.look_at is given, but camera.position looks along its path", "remove look_at or orient: along");
    if (const YamlNode* up = section["position"].node->find("up"))
        section["position"].with(*up, "camera.position.up").error("camera.position.up is given, but a camera has its own up", "write it as camera.up");
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
    read_place(section, camera);
    camera.dolly_m = read_number_track(section["dolly"]);
    camera.shake = read_shake(section["shake"]);
    assign(camera.up, read_direction_track(section["up"]));
    camera.up_given = section.has("up");
    camera.focal_length_mm = read_number_track(section["focal_length"]);
    camera.vertical_fov_rad = read_number_track(section["vertical_fov"]);
    read_sensor(section, camera);
    camera.f_stop = read_number_track(section["f_stop"]);
    camera.focus = read_focus(section["focus"]);
    read_blades(section["blades"], camera);
    return camera;
}

}  // namespace kadr
