#include <fmt/format.h>
#include <gmock/gmock.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <random>

#include "base/text.h"
#include "shot/shot_fixture.h"
#include "shot/shot_hash.h"
#include "shot/units.h"

namespace kadr {
namespace {

RC_GTEST_PROP(Units, EveryUnitScalesAsItsRowSays, (double number)) {
    RC_PRE(std::isfinite(number) && std::abs(number) < 1e290);
    for (const UnitSpec& unit : unit_table()) {
        const ParsedQuantity parsed =
            parse_quantity(fmt::format("{} {}", format_number(number), unit.name), unit.quantity);
        RC_ASSERT(parsed.problem == ParsedQuantity::Problem::none);
        RC_ASSERT(parsed.value == number * unit.multiplier / unit.divisor);
    }
}

RC_GTEST_PROP(Units, ABareNumberHasTheNaturalUnit, (double number)) {
    RC_PRE(std::isfinite(number) && std::abs(number) < 1e290);
    for (const Quantity quantity :
         {Quantity::angle, Quantity::time, Quantity::length, Quantity::lens, Quantity::power}) {
        const std::string text = format_number(number);
        RC_ASSERT(parse_quantity(text, quantity).value ==
                  parse_quantity(fmt::format("{}{}", text, natural_unit(quantity)), quantity).value);
        RC_ASSERT(parse_quantity(text, quantity).value == from_natural(quantity, number));
    }
}

RC_GTEST_PROP(Units, AnyTextEndsInANumberOrAProblem, (std::string text)) {
    const ParsedQuantity parsed = parse_quantity(text, Quantity::length);
    RC_ASSERT(parsed.problem != ParsedQuantity::Problem::none || std::isfinite(parsed.value));
}

TEST(Units, RefuseWhatIsNoNumber) {
    using Problem = ParsedQuantity::Problem;
    for (const char* text : {"", "x", "0x10", "1_000", "1,5", "--1", "+-1", "1 2", "- 1", "1.2.3"})
        EXPECT_EQ(parse_quantity(text, Quantity::length).problem, Problem::not_a_number) << text;
    for (const char* text : {".inf", "-.inf", "+.INF", ".nan", "nan", "inf", "Infinity"})
        EXPECT_EQ(parse_quantity(text, Quantity::length).problem, Problem::not_finite) << text;
    for (const char* text : {"1e400", "-1e400", "1e308 km"})
        EXPECT_EQ(parse_quantity(text, Quantity::length).problem, Problem::out_of_range) << text;
    EXPECT_EQ(parse_quantity("1 inch", Quantity::length).problem, Problem::wrong_unit);
}

/// The fixture's folder for property and fuzz loops, which rapidcheck runs outside of fixtures.
class Loops : public ShotTest {
protected:
    void check(bool ok) { EXPECT_TRUE(ok); }
};

TEST_F(Loops, KeysComeBackInOrderWithTheirValues) {
    check(rc::check("keys in the order of their times", [](const std::map<int, int>& keys, bool frames) {
        RC_PRE(!keys.empty());
        std::string text;
        std::map<int, int> distinct;
        for (const auto& [time, value] : keys) distinct[time % 1000000] = value;
        RC_PRE(distinct.size() == keys.size());
        for (const auto& [time, value] : distinct)
            text +=
                fmt::format("{}{} {}: [{}, 0, 0]", text.empty() ? "" : ", ", time, frames ? "f" : "s", value);
        const Track<glm::dvec3> track = parse_camera("{ position: { keys: { " + text + " } } }").camera.position.keyed;
        RC_ASSERT(track.keys.size() == distinct.size());
        std::size_t i = 0;
        for (const auto& [time, value] : distinct) {
            RC_ASSERT(track.keys[i].time_s == (frames ? time / 24.0 : time));
            RC_ASSERT(track.keys[i].value.x == value);
            ++i;
        }
    }));
}

Hash hash_of(const Shot& shot) {
    Hasher hasher;
    hash_shot(shot, hasher);
    return hasher.finish();
}
Hash view_hash_of(const Shot& shot) {
    Hasher hasher;
    hash_view(shot, hasher);
    return hasher.finish();
}

TEST_F(Loops, HashSeesWhatChangesPixelsAndNothingElse) {
    const Hash base = hash_of(parse(""));
    for (const char* same : {"name: other", "timing: { frames: 0-9 }", "output: { video: a.mp4, frames: x.png }",
                             "# a comment", "view: { transform: agx }", "output: { png_bits: 16 }"}) {
        EXPECT_EQ(hash_of(parse(same)), base) << same;
    }
    for (const char* other : {"timing: { fps: 25 }",
                              "timing: { first: 1 }",
                              "image: { size: [1280, 721] }",
                              "image: { pixel_aspect: 2 }",
                              "shutter: 0",
                              "lights: [ { type: point } ]",
                              "environment: { strength: 2 }",
                              "environment: { visible: false }",
                              "use_scene_lights: false",
                              "render: { samples: 65 }",
                              "render: { integrator: direct }",
                              "render: { bounces: { total: 8, glossy: 7 } }",
                              "render: { filter: box }",
                              "render: { clamp: { direct: 1 } }",
                              "render: { clamp: { indirect: 1 } }",
                              "render: { seed: 1 }",
                              "render: { seed: { animated: true } }",
                              "render: { cull_backfaces: true }",
                              "render: { fresnel: exact }",
                              "render: { motion_tolerance: 1 }",
                              "render: { motion_frames: 5 }",
                              "render: { motion_frames: { count: 5, mix: matrix } }",
                              "output: { aovs: [ depth ] }"}) {
        EXPECT_NE(hash_of(parse(other)), base) << other;
    }
    for (const char* camera : {"{ position: [0, 0, 6] }", "{ look_at: a }", "{ up: [1, 0, 0] }",
                               "{ focal_length: 50 mm }", "{ vertical_fov: 40 deg }", "{ f_stop: 2 }", "{ focus: 2 }",
                               "{ blades: 5 }", "{ sensor: { fit: vertical } }", "{ gltf: a/C }"}) {
        EXPECT_NE(hash_of(parse_camera(camera)), base) << camera;
    }
    for (const char* scene :
         {"{ gltf: a.glb, transform: { scale: 2 } }", "{ gltf: a.glb, transform: { rotate: [0, 1, 0] } }",
          "{ gltf: a.glb, animation: { clip: none } }", "{ gltf: a.glb, animation: { speed: 2 } }",
          "{ gltf: a.glb, animation: { start: 1 } }"}) {
        EXPECT_NE(hash_of(parse_scene(scene)), base) << scene;
    }
    EXPECT_EQ(hash_of(parse_scene("{ id: a, gltf: b.gltf }")),
              base);  // the content of assets is hashed where it is read
    for (const char* view :
         {"view: { transform: agx }", "view: { exposure: 1 }", "view: { exposure: auto }", "output: { png_bits: 16 }"})
        EXPECT_NE(view_hash_of(parse(view)), view_hash_of(parse(""))) << view;
}

constexpr const char* kSeedShot = R"(kadr: 1
name: seed
timing: { fps: 24000/1001, frames: "0-9, 12" }
image: { size: [640, 360] }
scenes:
  - id: a
    gltf: a.glb
    transform: { translate: &t [0, 1, 0], rotate: { axis: [0, 1, 0], angle: { keys: { 0 s: 0, 1 s: 90 deg } } }, scale: 2 }
    animation: { clip: all, start: 12 f }
camera: { position: { keys: { 0 f: [3, 1, 4], 9 f: { value: *t, ease: in-out } }, interpolate: smooth }, look_at: a/Node, f_stop: 2.8, focus: 2 m }
shutter: { angle: 180 deg, phase: centre }
lights:
  - { id: key, type: spot, intensity: 800 cd, position: [2, 3, 2], look_at: a, inner: 20 deg, outer: 35 deg }
environment: { color: [0.5, 0.8, 0.9], strength: 2 }
render: { samples: 16, bounces: { total: 4 }, filter: box, seed: { value: 3, animated: true } }
view: { transform: agx, exposure: { iso: 100, time: 10 ms, f_stop: 8 } }
output: { frames: "out.{frame:04}.exr", aovs: [ depth ], video: { file: out.mp4, crf: 20 } }
)";

/// One random edit: a byte or a piece of the format's own alphabet put in, a stretch removed or copied elsewhere.
std::string mutated(std::string text, std::mt19937& random) {
    static const std::vector<std::string> kPieces{
        "[",    "]",     "{",    "}", ":",  ": ",       ",",     "\n",
        "- ",   "&a ",   "*a",   "'", "\"", "|",        ">",     "#",
        "?",    "!",     "%",    "@", "\t", "null",     "1e400", ".nan",
        "keys", "---\n", "<<: ", "0", "-",  "\xC3\xA9", "\xFF",  std::string(1, '\0')};
    const auto below = [&](std::size_t n) { return n == 0 ? 0 : random() % n; };
    const std::size_t at = below(text.size() + 1), length = below(12);
    switch (below(4)) {
        case 0:
            return text.insert(at, kPieces[below(kPieces.size())]);
        case 1:
            return text.erase(at, length);
        case 2:
            return text.insert(at, text.substr(below(text.size() + 1), length * 4));
        default:
            return text.insert(at, std::string(1, static_cast<char>(below(256))));
    }
}

TEST_F(Loops, MutatedShotsEndInAShotOrInMessages) {
    constexpr unsigned kSeed = 20240917;  // fixed: a failure can be repeated; printed with it
    constexpr int kRounds = 3000;
    std::mt19937 random(kSeed);
    int shots = 0, refused = 0;
    for (int round = 0; round < kRounds; ++round) {
        std::string text = kSeedShot;
        for (unsigned edits = 1 + random() % 4; edits > 0; --edits) text = mutated(text, random);
        try {
            parse_shot_text(text, "shot.yaml");
            ++shots;
        } catch (const InputError& error) {
            ++refused;
            ASSERT_FALSE(error.diagnostics().empty());
        } catch (const std::exception& error) {
            FAIL() << "seed " << kSeed << ", round " << round << ": " << error.what() << "\n" << text;
        }
    }
    EXPECT_GT(shots, 0);
    EXPECT_GT(refused, kRounds / 2);
}

}  // namespace
}  // namespace kadr
