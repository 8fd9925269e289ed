// Shadow rays go to their light: what lies just before it hides it, what lies just behind it does not, and no light that is
// made of triangles hides itself.
#include <gtest/gtest.h>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

constexpr double kHeight = 2;  // of the lamp over the floor

glm::dmat4 turned_over() { return glm::rotate(glm::dmat4(1), kPi, glm::dvec3(1, 0, 0)); }

kernels::Material glowing() {
    kernels::Material m = material({0, 0, 0}, 0, 1);
    m.emission = {20, 20, 20};
    return m;
}

enum class Lamp { point, ball, panel, mesh, mesh_instance, turning_mesh };
constexpr Lamp kLamps[] = {Lamp::point, Lamp::ball, Lamp::panel, Lamp::mesh, Lamp::mesh_instance, Lamp::turning_mesh};
constexpr double kBallRadius = 0.1;

kernels::Light light_of(Lamp lamp) {
    kernels::Light light;
    light.kind = lamp == Lamp::panel ? kernels::LightKind::area : kernels::LightKind::point;
    light.radiance = {20, 20, 20};
    light.position = {0, 0, kHeight};
    light.axis_u = {0.25f, 0, 0}, light.axis_v = {0, 0.25f, 0};
    light.radius = lamp == Lamp::ball ? static_cast<float>(kBallRadius) : 0.0f;
    return light;
}

/// Moves by an arc of 4 degrees about an axis that lies in its plane a metre away: it stays where it is but for 4 cm to
/// either side, and Embree's slerp has it elsewhere by up to 2.5e-5 m.
std::vector<glm::dmat4> on_an_arm(const glm::dmat4& place) {
    std::vector<glm::dmat4> frames;
    const glm::dvec3 pivot(1, 0, kHeight);
    for (const double degrees : {-2.0, 2.0})
        frames.push_back(glm::translate(glm::dmat4(1), pivot) * glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 0, 1)) *
                         glm::translate(glm::dmat4(1), -pivot) * place);
    return frames;
}

/// A floor under a lamp, seen from below it, with light straight from the lamp alone.
SmallScene floor_under(Lamp lamp) {
    SmallScene s;
    s.snapshot.settings.max_bounces = 0;
    s.camera({0, 0, 1}, {0, 0, 0}, 0.5);
    s.add_instance(s.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}, 4));
    if (lamp < Lamp::mesh) {
        s.add_light(light_of(lamp));
        return s;
    }
    const glm::dmat4 at = place({0, 0, kHeight}, 0.25) * turned_over();
    const unsigned square = s.add_mesh(unit_square());
    if (lamp == Lamp::turning_mesh) s.add_moving(square, glowing(), on_an_arm(at));
    else s.add_instance(square, glowing(), at, lamp == Lamp::mesh);
    return s;
}

void add_sheet(SmallScene& s, double height) { s.add_instance(s.add_mesh(unit_square()), material({0.5f, 0.5f, 0.5f}, 0, 1), place({0, 0, height}, 1)); }

double lowest(Lamp lamp) { return lamp == Lamp::ball ? kHeight - kBallRadius : kHeight; }
double highest(Lamp lamp) { return lamp == Lamp::ball ? kHeight + kBallRadius : kHeight; }

TEST(ShadowRays, MeetWhatLiesJustBeforeTheirLight) {
    for (const Lamp lamp : kLamps) {
        SmallScene open = floor_under(lamp);
        ASSERT_GT(open.render(16).mean(), 0.1) << static_cast<int>(lamp);
        // What a slerp may be off by comes on top of the rounding of coordinates.
        for (const double gap : {1e-4, 1e-3, 1e-1, lamp == Lamp::turning_mesh ? 6e-5 : 2e-5}) {
            SmallScene covered = floor_under(lamp);
            add_sheet(covered, lowest(lamp) - gap);
            EXPECT_EQ(covered.render(16).mean(), 0) << static_cast<int>(lamp) << ", " << gap;
        }
    }
}

TEST(ShadowRays, AreNotStoppedByWhatLiesJustBehindTheirLight) {
    for (const Lamp lamp : kLamps) {
        SmallScene open = floor_under(lamp);
        const double lit = open.render(16).mean();
        for (const double gap : {2e-5, 1e-3}) {
            SmallScene backed = floor_under(lamp);
            add_sheet(backed, highest(lamp) + gap);
            EXPECT_NEAR(backed.render(16).mean() / lit, 1, 1e-6) << static_cast<int>(lamp) << ", " << gap;  // the same samples
        }
    }
}

/// Panels are built into ceilings; neither the panel nor the ceiling is in front.
TEST(ShadowRays, AreNotStoppedByTheCeilingThatAPanelLiesIn) {
    for (const double size : {1.0, 8.0})
        for (const double tilt : {0.0, 0.3}) {
            const auto lit = [&](bool ceiling) {
                SmallScene s;
                s.snapshot.settings.max_bounces = 0;
                s.camera({0, 0, 1}, {0, 0, 0}, 0.5);
                s.add_instance(s.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}, 4));
                const glm::dmat4 turn = glm::rotate(glm::dmat4(1), tilt, glm::dvec3(0, 1, 0));
                const auto turned = [&](glm::dvec3 v) {
                    const glm::dvec3 t(turn * glm::dvec4(v, 0));
                    return kernels::Vec3f{static_cast<float>(t.x), static_cast<float>(t.y), static_cast<float>(t.z)};
                };
                kernels::Light panel = light_of(Lamp::panel);
                panel.axis_u = turned({0.25, 0, 0}), panel.axis_v = turned({0, 0.25, 0}), panel.direction = turned({0, 0, -1});
                s.add_light(panel);
                if (ceiling) s.add_instance(s.add_mesh(unit_square()), material({0, 0, 0}, 0, 1), place({0, 0, kHeight}) * turn * place({0, 0, 0}, size));
                return s.render(64).mean();
            };
            EXPECT_NEAR(lit(true) / lit(false), 1, 1e-3) << size << ", " << tilt;  // a share of rays that the rounding of a tilted plane may stop
        }
}

/// A small lamp of triangles far from the render origin: its place has few digits left, and it must not hide itself.
TEST(ShadowRays, AreNotStoppedByTheLampItselfFarAway) {
    const auto lit = [](double away, Lamp lamp) {
        SmallScene s;
        s.snapshot.settings.max_bounces = 0;
        const glm::dvec3 there(away, -away, away);
        s.camera(there + glm::dvec3(0, 0, 1), there, 0.5);
        s.add_instance(s.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place(there, 4));
        kernels::Material m = glowing();
        m.emission = m.emission * 100.0f;
        const glm::dmat4 at = place(there + glm::dvec3(0, 0, kHeight), 0.02);
        const unsigned ball = s.add_mesh(unit_sphere(16));
        if (lamp == Lamp::turning_mesh) {
            std::vector<glm::dmat4> frames;
            for (const double degrees : {-2.0, 2.0}) frames.push_back(at * glm::rotate(glm::dmat4(1), glm::radians(degrees), glm::dvec3(0, 0, 1)));
            s.add_moving(ball, m, frames);
        } else {
            s.add_instance(ball, m, at, lamp == Lamp::mesh);
        }
        return s.render(64).mean();
    };
    for (const Lamp lamp : {Lamp::mesh, Lamp::mesh_instance, Lamp::turning_mesh}) {
        const double near = lit(0, lamp);
        ASSERT_GT(near, 0.01);
        // At 100 m a coordinate is a multiple of 8e-6 m, which displaces every point of the lamp, 2 cm large, by 4e-4 of its size.
        for (const double away : {1.0, 10.0, 100.0}) EXPECT_NEAR(lit(away, lamp) / near, 1, 0.01) << away << ", " << static_cast<int>(lamp);
    }
}

TEST(ShadowRays, FindALampThatTurnsAsBrightAsOneAtRest) {
    // It moves by 3.5 cm to either side of a metre's arm, 2 m above the floor: second order in 0.0175.
    EXPECT_NEAR(floor_under(Lamp::turning_mesh).render(64).mean() / floor_under(Lamp::mesh_instance).render(64).mean(), 1, 0.005);
}

}  // namespace
}  // namespace kadr::test
