// Paths, orbits, dolly and shake: what they hold, and what is said where they make no sense.
#include <gmock/gmock.h>

#include <numbers>

#include "shot/shot_fixture.h"
#include "shot/shot_hash.h"

namespace kadr {
namespace {

class PositionText : public ShotTest {
protected:
    /// Messages about a camera, without the excerpts.
    static std::string camera(const std::string& keys) {
        const std::string messages = errors_of("kadr: 1\nscenes: [ a.glb ]\ncamera: { " + keys + " }\n");
        std::string result;
        for (std::size_t begin = 0; begin < messages.size();) {
            const std::size_t end = std::min(messages.find('\n', begin), messages.size());
            const std::string line = messages.substr(begin, end - begin);
            if (line.rfind("    ", 0) != 0) result += (result.empty() ? "" : "\n") + line;
            begin = end + 1;
        }
        return result;
    }
    static CameraSpec read(const std::string& keys) { return parse_camera("{ " + keys + " }").camera; }
};

TEST_F(PositionText, APathIsTravelledFromZeroToTo) {
    const CameraSpec camera = read("position: { path: [[0, 0, 0], [1 m, 20 cm, 0], [3, 0, 0]], from: 12 f, to: 4 s, ease: in-out }");
    ASSERT_TRUE(camera.position.path);
    EXPECT_EQ(camera.position.path->path.points()[1], glm::dvec3(1, 0.2, 0));
    EXPECT_FALSE(camera.position.path->path.closed());
    EXPECT_FALSE(camera.position.turns_along());
    const Track<double>& at = camera.position.path->at;
    ASSERT_EQ(at.keys.size(), 2u);
    EXPECT_EQ(at.keys[0].time_s, 0.5);
    EXPECT_EQ(at.keys[1].time_s, 4);
    EXPECT_EQ(at.keys[1].value, 1);
    EXPECT_TRUE(at.keys[0].ease);
}

TEST_F(PositionText, APathTakesAKeyedFraction) {
    const PositionTrack place = parse_scene("{ gltf: a.glb, transform: { translate: { path: [[0, 0, 0], [1, 0, 0], [1, 0, 1]], closed: true, orient: along, up: [0, 0, 1], "
                                            "at: { keys: { 0 s: 0, 2 s: 3 }, after: continue } } } }").scenes[0].transform.translate;
    ASSERT_TRUE(place.path);
    EXPECT_TRUE(place.path->path.closed());
    EXPECT_TRUE(place.turns_along());
    EXPECT_EQ(place.path->up, glm::dvec3(0, 0, 1));
    EXPECT_EQ(place.path->at.keys[1].value, 3);
    EXPECT_EQ(place.path->where, (SourceLocation{"shot.yaml", 2, 58}));
}

TEST_F(PositionText, PathsNeedPointsThatLieApart) {
    EXPECT_EQ(camera("position: { path: [[0, 0, 0]], to: 1 s }"),
              "shot.yaml:3:29: error: camera.position.path has 1 point\n"
              "  expected two points or more");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], closed: true, to: 1 s }"),
              "shot.yaml:3:29: error: camera.position.path has 2 points and is closed\n"
              "  expected three points or more");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [0, 0, 0]], to: 1 s }"),
              "shot.yaml:3:41: error: points 0 and 1 of camera.position.path are the same\n"
              "  expected neighbours to lie apart; remove one, and wait with at: { keys: ... }");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 0, 0]], closed: true, to: 1 s }"),
              "shot.yaml:3:63: error: points 0 and 3 of camera.position.path are the same\n"
              "  closed: true joins the ends itself; remove the last point");
    EXPECT_EQ(camera("position: { path: somewhere, to: 1 s }"),
              "shot.yaml:3:29: error: camera.position.path is 'somewhere'\n"
              "  expected a list of points [x, y, z]");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0]], to: 1 s }"),
              "shot.yaml:3:41: error: camera.position.path[1] is a list of 2\n"
              "  expected a list of points [x, y, z]");
}

TEST_F(PositionText, JourneysNeedAnEnd) {
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]] }"),
              "shot.yaml:3:21: error: camera.position.to is missing\n"
              "  add `to: 4 s`, when the end is reached; or give at as a track");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], from: 1 s, to: 12 f }"),
              "shot.yaml:3:68: error: camera.position.to is 12 f, and from is 1 s\n"
              "  expected a time after from");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, at: { keys: { 0 s: 0, 1 s: 1 } } }"),
              "shot.yaml:3:57: error: camera.position.to is given, but camera.position.at says it\n"
              "  remove to; its keys have times and eases");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], at: { keys: { 0 s: 0, 1 s: 1.5 } } }"),
              "shot.yaml:3:57: error: camera.position.at reaches 1.5, and the path is open\n"
              "  expected fractions of the path from 0 to 1; closed: true goes round again");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: late }"),
              "shot.yaml:3:57: error: camera.position.to is 'late'\n"
              "  expected a time such as 2.5 s, 80 ms, 12 f or a number of seconds");
}

TEST_F(PositionText, TurningAlongBelongsToWhatTurns) {
    EXPECT_EQ(camera("look_at: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, orient: along }"),
              "shot.yaml:3:69: error: camera.look_at.orient is given, but camera.look_at is only a point\n"
              "  orient: along belongs to camera.position and to a scene's transform.translate");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, orient: along }, look_at: [0, 0, 0]"),
              "shot.yaml:3:88: error: camera.look_at is given, but camera.position looks along its path\n"
              "  remove look_at or orient: along");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, orient: along, up: [0, 0, 1] }"),
              "shot.yaml:3:81: error: camera.position.up is given, but a camera has its own up\n"
              "  write it as camera.up");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, up: [0, 0, 1] }"),
              "shot.yaml:3:66: error: camera.position.up is given without orient\n"
              "  up belongs to orient: along");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], to: 1 s, orient: sideways }"),
              "shot.yaml:3:70: error: camera.position.orient other than along is not supported yet\n"
              "  expected along");
    EXPECT_EQ(camera("position: { path: [[0, 0, 0], [1, 0, 0]], orbit: { radius: 1 }, to: 1 s }"),
              "shot.yaml:3:53: error: camera.position.path and camera.position.orbit exclude each other\n"
              "  remove one of the two");
}

TEST_F(PositionText, AnOrbitSharesItsMiddleWithLookAt) {
    const CameraSpec given = read("orbit: { around: [1, 2, 3], radius: 4, height: 50 cm, turns: -2, start: 90 deg, from: 1 s, to: 3 s }");
    const OrbitMotion& orbit = *given.position.orbit;
    EXPECT_EQ(orbit.around, Track<glm::dvec3>(glm::dvec3(1, 2, 3)));
    EXPECT_EQ(orbit.radius_m, Track<double>(4.0));
    EXPECT_EQ(orbit.height_m, Track<double>(0.5));
    EXPECT_DOUBLE_EQ(orbit.start_rad, std::numbers::pi / 2);
    EXPECT_EQ(orbit.turns.keys[0].time_s, 1);
    EXPECT_EQ(orbit.turns.keys[1].value, -2);
    EXPECT_EQ(given.look_at, Target(PositionTrack(glm::dvec3(1, 2, 3))));
    const CameraSpec looked = read("orbit: { radius: 4, to: 3 s }, look_at: [1, 2, 3]");
    EXPECT_EQ(looked.position.orbit->around, Track<glm::dvec3>(glm::dvec3(1, 2, 3)));
    EXPECT_EQ(looked.position.orbit->turns.keys[1].value, 1);
    EXPECT_EQ(read("orbit: { radius: 4, to: 3 s }, look_at: a/Visor").around->text, "a/Visor");
    const CameraSpec node = read("orbit: { around: a/Visor, radius: 4, to: 3 s }");
    EXPECT_EQ(node.around->text, "a/Visor");
    EXPECT_EQ(std::get<NodeReference>(node.look_at).text, "a/Visor");
    const CameraSpec both = read("orbit: { around: a/Visor, radius: 4, turns: { keys: { 0 s: 0, 1 s: 0.5 }, after: continue } }, look_at: [0, 9, 0]");
    EXPECT_EQ(both.look_at, Target(PositionTrack(glm::dvec3(0, 9, 0))));
    EXPECT_EQ(both.position.orbit->turns.after, Extrapolation::continued);
}

TEST_F(PositionText, OrbitsAreChecked) {
    EXPECT_EQ(camera("orbit: 4"),
              "shot.yaml:3:18: error: camera.orbit is 4\n"
              "  expected a map of around, radius, height, turns, start, from, to, ease");
    EXPECT_EQ(camera("orbit: { radius: 0, to: 1 s }"),
              "shot.yaml:3:28: error: camera.orbit.radius is 0\n"
              "  expected more than 0 m");
    EXPECT_EQ(camera("orbit: { radius: 2, to: 1 s }, position: [0, 0, 1]"),
              "shot.yaml:3:42: error: camera.position and camera.orbit exclude each other\n"
              "  remove one of the two");
    EXPECT_EQ(camera("orbit: { radius: 2, turns: { keys: { 0 s: 0, 1 s: 1 } }, ease: in }"),
              "shot.yaml:3:74: error: camera.orbit.ease is given, but camera.orbit.turns says it\n"
              "  remove ease; its keys have times and eases");
    EXPECT_EQ(camera("orbit: { radius: 2, to: 1 s }, look_at: { orbit: { radius: 1, to: 1 s } }"),
              "shot.yaml:3:18: error: camera.orbit.around is missing, and camera.look_at travels\n"
              "  add `around: [x, y, z]`");
    EXPECT_EQ(camera("position: { orbit: { around: a/Visor, radius: 2, to: 1 s } }"),
              "shot.yaml:3:40: error: camera.position.orbit.around is 'a/Visor'\n"
              "  expected [x, y, z]; only camera.orbit goes around nodes");
    EXPECT_EQ(camera("position: { orbit: { radius: 2, to: 1 s }, ease: in }"),
              "shot.yaml:3:60: error: camera.position.ease is given, but camera.position has no path\n"
              "  it belongs to path; an orbit's own keys stand inside orbit: { ... }");
}

TEST_F(PositionText, DollyAndShakeAreTracks) {
    const CameraSpec camera = read("dolly: { keys: { 0 s: 0 m, 1 s: 50 cm } }, shake: { amplitude: [1 cm, 2 cm, 0], angle: { keys: { 0 s: 0, 1 s: 90 deg } }, frequency: 5, seed: 9 }");
    EXPECT_EQ(camera.dolly_m->keys[1].value, 0.5);
    ASSERT_TRUE(camera.shake);
    EXPECT_EQ(camera.shake->amplitude_m, Track<glm::dvec3>(glm::dvec3(0.01, 0.02, 0)));
    EXPECT_DOUBLE_EQ(camera.shake->angle_rad.keys[1].value.y, std::numbers::pi / 2);
    EXPECT_EQ(camera.shake->frequency_hz, 5);
    EXPECT_EQ(camera.shake->seed, 9u);
}

TEST_F(PositionText, ShakeIsChecked) {
    EXPECT_EQ(camera("shake: { frequency: 4 }"),
              "shot.yaml:3:18: error: camera.shake has neither amplitude nor angle\n"
              "  add `amplitude: 1 cm` or `angle: 0.4 deg`");
    EXPECT_EQ(camera("shake: { amplitude: 1 cm, frequency: 0 }"),
              "shot.yaml:3:48: error: camera.shake.frequency is 0\n"
              "  expected more than 0 and at most 1000");
    EXPECT_EQ(camera("shake: strong"),
              "shot.yaml:3:18: error: camera.shake is 'strong'\n"
              "  expected a map of amplitude, angle, frequency, seed");
}

TEST_F(PositionText, EverythingIsInTheHash) {
    const auto hash = [](const std::string& keys) {
        Hasher hasher;
        hash_shot(parse_camera("{ " + keys + " }"), hasher);
        return hasher.finish();
    };
    const std::vector<std::string> different{
        "",
        "up: [0, 1, 0]",
        "dolly: 1",
        "shake: { amplitude: 1 }",
        "shake: { amplitude: 2 }",
        "shake: { amplitude: 1, angle: 1 }",
        "shake: { amplitude: 1, frequency: 4 }",
        "shake: { amplitude: 1, seed: 4 }",
        "position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], to: 1 s }",
        "position: { path: [[0, 0, 0], [1, 0, 0], [1, 2, 0]], to: 1 s }",
        "position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], to: 2 s }",
        "position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], to: 1 s, closed: true }",
        "position: { path: [[0, 0, 0], [1, 0, 0], [1, 1, 0]], to: 1 s, orient: along }",
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] } }",
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] }, before: repeat }",
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] }, after: repeat }",
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] }, interpolate: smooth }",
        "position: { keys: { 0 s: [0, 0, 0], 1 s: [1, 0, 0] }, interpolate: smooth, overshoot: false }",
        "orbit: { radius: 1, to: 1 s }",
        "orbit: { radius: 2, to: 1 s }",
        "orbit: { radius: 1, to: 1 s, height: 1 }",
        "orbit: { radius: 1, to: 1 s, turns: 2 }",
        "orbit: { radius: 1, to: 1 s, start: 2 }",
        "orbit: { around: [0, 0, 1], radius: 1, to: 1 s }",
        "orbit: { around: a, radius: 1, to: 1 s }",
    };
    for (std::size_t i = 0; i < different.size(); ++i)
        for (std::size_t k = i + 1; k < different.size(); ++k) EXPECT_NE(hash(different[i]), hash(different[k])) << different[i] << "\n" << different[k];
}

}  // namespace
}  // namespace kadr
