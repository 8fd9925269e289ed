// Positions that travel: paths, orbits; and shake.
#include <fmt/format.h>

#include <algorithm>

#include "base/text.h"
#include "shot/key_reader.h"
#include "shot/track_reader.h"

namespace kadr {

namespace {

std::optional<Path> read_path_points(const Field& field, bool closed) {
    if (!field.node->is_list()) {
        field.mismatch();
        return std::nullopt;
    }
    std::vector<glm::dvec3> points;
    for (std::size_t i = 0; i < field.node->items.size(); ++i)
        if (const auto point = read_vector3(field.with(field.node->items[i], fmt::format("{}[{}]", field.name, i)))) points.push_back(*point);
    const std::size_t count = field.node->items.size(), least = closed ? 3 : 2;
    if (points.size() != count) return std::nullopt;
    if (count < least) {
        field.error(fmt::format("{} has {} point{}{}", field.name, count, count == 1 ? "" : "s", closed ? " and is closed" : ""),
                    fmt::format("expected {} points or more", closed ? "three" : "two"));
        return std::nullopt;
    }
    for (std::size_t i = 0; i < (closed ? count : count - 1); ++i) {
        const std::size_t next = (i + 1) % count;
        if (points[i] != points[next]) continue;
        field.with(field.node->items[std::max(i, next)], field.name)
            .error(fmt::format("points {} and {} of {} are the same", std::min(i, next), std::max(i, next), field.name),
                   next == 0 ? "closed: true joins the ends itself; remove the last point" : "expected neighbours to lie apart; remove one, and wait with at: { keys: ... }");
        return std::nullopt;
    }
    return Path(std::move(points), closed);
}

/// From 0 at `from` to `total` at `to`; nothing after reporting what is missing.
std::optional<Track<double>> read_journey(const Section& section, double total, std::string_view keyed) {
    const double from = read_time_point(section["from"]).value_or(0);
    const Field to_field = section["to"];
    const auto ease = read_ease(section["ease"]);
    if (!to_field) {
        section.context().problems.error(section.node()->place, fmt::format("{}.to is missing", section.name()),
                                         fmt::format("add `to: 4 s`, when the end is reached; or give {} as a track", keyed));
        return std::nullopt;
    }
    const auto to = read_time_point(to_field);
    if (!to) return std::nullopt;
    if (!(*to > from)) {
        to_field.error(fmt::format("{} is {}, and from is {} s", to_field.name, to_field.node->text, format_number(from)), "expected a time after from");
        return std::nullopt;
    }
    Track<double> track;
    track.keys = {{from, 0, ease, {}, {}}, {*to, total, {}, {}, {}}};
    return track;
}

void refuse_beside_track(const Section& section, std::string_view keyed) {
    for (const char* name : {"from", "to", "ease"}) {
        if (const Field given = section[name])
            given.error(fmt::format("{} is given, but {}.{} says it", given.name, section.name(), keyed), fmt::format("remove {}; its keys have times and eases", name));
    }
}

void check_fractions(const Field& at, const Track<double>& track) {
    for (const Key<double>& key : track.keys) {
        if (key.value >= 0 && key.value <= 1) continue;
        return at.error(fmt::format("{} reaches {}, and the path is open", at.name, format_number(key.value)),
                        "expected fractions of the path from 0 to 1; closed: true goes round again");
    }
}

/// What a fraction of a path that does not go round may be.
constexpr FieldSpec kOpenPath{.path = "motion.at", .low = 0, .high = 1};

std::optional<Track<double>> read_fraction(const Section& section, bool closed) {
    const Field at = section["at"];
    if (!at) return read_journey(section, 1, "at");
    refuse_beside_track(section, "at");
    auto track = read_number_track(at);
    if (track && !closed) check_fractions(at, *track), note_limits(at, *track, kOpenPath);
    return track;
}

void read_orientation(const Section& section, bool may_turn, PathMotion& motion) {
    const Field orient = section["orient"], up = section["up"];
    motion.along = read_choice_index(orient).has_value();
    if (orient && !may_turn) orient.error(fmt::format("{} is given, but {} is only a point", orient.name, section.name()), "orient: along belongs to camera.position and to a scene's transform.translate");
    if (up && !orient) up.error(fmt::format("{} is given without orient", up.name), "up belongs to orient: along");
    const auto direction = read_vector3(up);
    if (direction && !(glm::length(*direction) > 0)) return up.error(fmt::format("{} is zero", up.name), "expected a direction, a vector of any length but zero");
    assign(motion.up, direction);
}

std::optional<PathMotion> read_path_motion(const Section& section, bool may_turn) {
    PathMotion motion;
    const Field points = section["path"];
    motion.where = location_of(points.node->place);
    const bool closed = read_boolean(section["closed"]).value_or(false);
    auto path = read_path_points(points, closed);
    read_orientation(section, may_turn, motion);
    auto at = read_fraction(section, closed);
    if (!path || !at) return std::nullopt;
    motion.path = std::move(*path);
    motion.at = std::move(*at);
    return motion;
}

/// Keys that belong to a path, on a position that orbits.
void refuse_path_keys(const Section& section) {
    for (const char* name : {"closed", "from", "to", "ease", "at", "orient", "up"}) {
        if (const Field given = section[name]) given.error(fmt::format("{} is given, but {} has no path", given.name, section.name()), "it belongs to path; an orbit's own keys stand inside orbit: { ... }");
    }
}

/// One number for all components, or three.
std::optional<glm::dvec3> read_one_or_three(const Field& field) {
    if (!field.node->is_scalar()) return read_vector3(field);
    const auto all = read_number(field);
    return all ? std::optional(glm::dvec3(*all)) : std::nullopt;
}
std::optional<glm::dvec3> read_one_or_three_rates(const Field& field, const glm::dvec3&) { return read_one_or_three(field); }

/// A node where one may be given, else a point.
std::optional<Track<glm::dvec3>> read_around(const Field& around, std::optional<NodeReference>* node) {
    if (!around) return std::nullopt;
    if (!around.node->is_scalar()) return read_vector3_track(around);
    if (node)
        *node = read_node(around);
    else
        around.error(fmt::format("{} is {}", around.name, shown_value(*around.node)), "expected [x, y, z]; only camera.orbit goes around nodes");
    return std::nullopt;
}

}  // namespace

std::optional<OrbitMotion> read_orbit(const Field& field, std::optional<NodeReference>* around_node) {
    if (!field) return std::nullopt;
    if (!field.node->is_map()) {
        field.mismatch();
        return std::nullopt;
    }
    const Section section(*field.context, field.node, "orbit", field.name);
    OrbitMotion orbit;
    assign(orbit.around, read_around(section["around"], around_node));
    assign(orbit.radius_m, read_number_track(section["radius"]));
    assign(orbit.height_m, read_number_track(section["height"]));
    assign(orbit.start_rad, read_number(section["start"]));
    const Field turns = section["turns"];
    const bool keyed = turns && turns.node->is_map();
    if (keyed) refuse_beside_track(section, "turns");
    auto track = turns ? read_number_track(turns) : Track<double>(1.0);
    if (track && !keyed) track = read_journey(section, track->keys.front().value, "turns");
    if (!track) return std::nullopt;
    orbit.turns = std::move(*track);
    return orbit;
}

std::optional<PositionTrack> read_position_track(const Field& field, bool may_turn) {
    if (!field) return std::nullopt;
    const bool travels = field.node->is_map() && (field.node->find("path") || field.node->find("orbit"));
    if (!travels) {
        auto keyed = read_vector3_track(field);
        return keyed ? std::optional<PositionTrack>(std::move(*keyed)) : std::nullopt;
    }
    const Section section(*field.context, field.node, "motion", field.name);
    if (section.exclusive("path", "orbit")) return std::nullopt;
    PositionTrack position;
    if (section.has("path")) {
        position.path = read_path_motion(section, may_turn);
    } else {
        refuse_path_keys(section);
        position.orbit = read_orbit(section["orbit"]);
    }
    return position.path || position.orbit ? std::optional(std::move(position)) : std::nullopt;
}

std::optional<Shake> read_shake(const Field& field) {
    if (!field) return std::nullopt;
    if (!field.node->is_map()) {
        field.mismatch();
        return std::nullopt;
    }
    const Section section(*field.context, field.node, "shake", field.name);
    constexpr KeyValues<glm::dvec3> kOneOrThree{read_one_or_three, read_one_or_three_rates};
    Shake shake;
    assign(shake.amplitude_m, read_track(section["amplitude"], kOneOrThree));
    assign(shake.angle_rad, read_track(section["angle"], kOneOrThree));
    assign(shake.frequency_hz, read_number(section["frequency"]));
    assign(shake.seed, read_integer(section["seed"]));
    if (!section.has("amplitude") && !section.has("angle"))
        field.error(fmt::format("{} has neither amplitude nor angle", field.name), "add `amplitude: 1 cm` or `angle: 0.4 deg`");
    return shake;
}

}  // namespace kadr
