// What moves within the shutter: instances, cameras, lights.
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "device/small_scene.h"

namespace kadr::test {
namespace {

kernels::Material glowing() {
    kernels::Material m = material({0, 0, 0}, 0, 1);
    m.emission = {1, 1, 1};
    return m;
}

TEST(Motion, SlidingSquareCoversEachPixelForItsTime) {
    // A square of width 2 slides by 2: where it is for half of the shutter, half of its light arrives.
    SmallScene s;
    s.camera({0, 0, 10}, {0, 0, 0}, 0.25);
    s.add_moving(s.add_mesh(unit_square()), glowing(), {place({-1, 0, 0}), place({1, 0, 0})});
    s.snapshot.settings.max_bounces = 0;
    const Image image = s.render(256).image;
    // World x of pixel column c is (c + 0.5 - 16) / 16 * 2.5; coverage is 1 - |x| / 2.
    for (const int c : {6, 10, 16, 22, 26}) {
        const double x = (c + 0.5 - 16) / 16 * 2.5;
        EXPECT_NEAR(image.at(c, 16, 1), 1 - std::abs(x) / 2, 0.03)
            << "column " << c;  // Owen-Sobol in one dimension: about 4/256 + the pixel's width
    }
}

TEST(Motion, QuarterTurnKeepsItsRadius) {
    // A small square on an arm turns by 90 degrees about z within the shutter: it stays on the circle, where matrices
    // interpolated linearly would cut the corner.
    SmallScene s;
    s.camera({0, 0, 10}, {0, 0, 0}, 0.15);
    s.snapshot.settings.width = s.snapshot.settings.height = 96;
    std::vector<glm::dmat4> frames;
    for (int k = 0; k <= 9; ++k)
        frames.push_back(glm::rotate(glm::dmat4(1), k * kPi / 18, glm::dvec3(0, 0, 1)) * place({1, 0, 0}, 0.03));
    s.add_moving(s.add_mesh(unit_square()), glowing(), frames);
    s.snapshot.settings.max_bounces = 0;
    const Image image = s.render(256).image;
    double sum = 0, radius = 0;
    double least = 10, most = 0;
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
            const double wx = (x + 0.5 - 48) / 48 * 1.5, wy = -(y + 0.5 - 48) / 48 * 1.5, v = image.at(x, y, 1);
            sum += v;
            radius += v * std::hypot(wx, wy);
            if (v > 0.002) least = std::min(least, std::hypot(wx, wy)), most = std::max(most, std::hypot(wx, wy));
        }
    EXPECT_NEAR(radius / sum, 1.0, 0.005);
    EXPECT_GT(least, 0.93);  // the half diagonal is 0.042 and a pixel 0.031
    EXPECT_LT(most, 1.07);
}

TEST(Motion, MatricesOfAnyNumberAreMixedAsTheyAreTraced) {
    // A sphere between three matrices: it goes there and back. Were shading to mix other ones than Embree, points would lie beside
    // the surface and shadow rays begin within it. On the way its light is that of one that rests at each place.
    const auto lit = [](const std::vector<glm::dmat4>& frames, bool mixed) {
        SmallScene s;
        s.add_moving(s.add_mesh(unit_sphere()), material({0.8f, 0.8f, 0.8f}, 0, 0.6f), frames);
        s.snapshot.motion.linear.edit(0) = mixed ? 1 : 0;
        kernels::Light sun;
        sun.kind = kernels::LightKind::directional;
        sun.radiance = {2, 2, 2};
        sun.direction = {-0.3f, -0.5f, -0.8124f};
        s.add_light(sun);
        return s.render(64).mean();
    };
    const std::vector<glm::dmat4> there_and_back{place({0, 0, 0}), place({1, 0.5, 0}), place({0, 0, 0})};
    EXPECT_NEAR(lit(there_and_back, true) / lit(there_and_back, false), 1, 1e-4);  // pure translations: both ways are the same
    // Matrices mixed through a turn of 90 degrees shrink to 0.707 half-way: a shared edge of both tables would not.
    const std::vector<glm::dmat4> turning{glm::dmat4(1), glm::rotate(glm::dmat4(1), kPi / 2, glm::dvec3(0, 0, 1)), glm::rotate(glm::dmat4(1), kPi, glm::dvec3(0, 0, 1))};
    const double shrunk = lit(turning, true) / lit(turning, false);
    // What the sphere covers is (1 - t)^2 + t^2 of itself, 2/3 on average; flatter as it is, it shows the sun other normals.
    EXPECT_LT(shrunk, 2.0 / 3);
    EXPECT_GT(shrunk, 0.6);
}

TEST(Motion, EmbreeAndTheKernelsAgreeOnMovingNormals) {
    // A sphere that spins and slides looks like one that only slides: positions from our own interpolation lie on the
    // surface that Embree hit, or shadow rays would start inside it.
    const auto render = [](bool spin) {
        SmallScene s;
        std::vector<glm::dmat4> frames;
        for (int k = 0; k <= 9; ++k)
            frames.push_back(place({k / 9.0, 0, 0}) * glm::rotate(glm::dmat4(1), spin ? k * kPi / 18 : 0.0,
                                                                  glm::normalize(glm::dvec3(1, 2, 3))));
        s.add_moving(s.add_mesh(unit_sphere()), material({0.8f, 0.8f, 0.8f}, 0, 0.6f), frames);
        kernels::Light sun;
        sun.kind = kernels::LightKind::directional;
        sun.radiance = {2, 2, 2};
        sun.direction = {-0.3f, -0.5f, -0.8124f};
        s.add_light(sun);
        return s.render(64).mean();
    };
    EXPECT_NEAR(render(true) / render(false), 1.0, 0.003);
}

TEST(Motion, ShearedFramesFollowTheirMatrix) {
    // Still, sheared, instanced: the same image as flattened.
    const auto render = [](bool fixed) {
        SmallScene s;
        glm::dmat4 shear(1);
        shear[1][0] = 0.7;
        s.add_instance(s.add_mesh(unit_sphere()), material({0.8f, 0.8f, 0.8f}, 0, 0.6f), shear, fixed);
        kernels::Light sun;
        sun.kind = kernels::LightKind::directional;
        sun.radiance = {2, 2, 2};
        sun.direction = {-0.3f, -0.5f, -0.8124f};
        s.add_light(sun);
        return s.render(64).mean();
    };
    EXPECT_NEAR(render(true) / render(false), 1.0, 0.002);
}

TEST(Motion, MovingCameraSmearsAndMovingLightDims) {
    SmallScene s;
    s.add_instance(s.add_mesh(unit_square()), glowing(), glm::dmat4(1));
    s.camera({-1, 0, 10}, {-1, 0, 0}, 0.25);
    kernels::CameraKey end = s.snapshot.camera_keys[0];
    end.position.x = 1;
    s.snapshot.camera_keys.push_back(end);
    s.snapshot.camera.key_count = 2;
    s.snapshot.settings.max_bounces = 0;
    const Image image = s.render(256).image;
    EXPECT_NEAR(image.at(16, 16, 1), 1, 0.03);
    EXPECT_NEAR(image.at(9, 16, 1), 1 - std::abs((9.5 - 16) / 16 * 2.5) / 2, 0.03);

    SmallScene dim;
    dim.snapshot.settings.integrator = kernels::IntegratorKind::direct;
    dim.add_instance(dim.add_mesh(unit_square()), material({0.8f, 0.8f, 0.8f}, 0, 1), place({0, 0, 0}, 10));
    kernels::Light light;
    light.kind = kernels::LightKind::directional;
    light.direction = {0, 0, -1};
    light.radiance = {0, 0, 0};
    dim.snapshot.light_keys = {light, light};
    dim.snapshot.light_keys[1].radiance = {4, 4, 4};
    dim.snapshot.lights = {{1, 1}};
    const double full = dim.render(64).mean();
    dim.snapshot.lights = {{0, 2}};
    EXPECT_NEAR(dim.render(64).mean() / full, 0.5, 0.01);
}

TEST(Motion, LayerHoldsThePixelsMovedSinceTheFrameBefore) {
    for (const bool fixed : {true, false}) {
        SmallScene s;
        s.camera({0, 0, 10}, {0, 0, 0}, 0.25);  // 32 pixels over 5 m: 6.4 pixels a metre
        s.add_instance(s.add_mesh(unit_square()), glowing(), place({0.25, 0, 0}), fixed);
        PreviousPlaces previous;
        previous.space_from_geometry = {fixed ? place({0.25, 0, 0}) : place({0, 0, 0})};
        previous.camera = s.snapshot.camera_keys[0];
        if (fixed) previous.camera.position.y += 0.5f;  // the camera sank: the square rose in the image, so y went down
        s.snapshot.previous = previous;
        FilmLayers layers;
        layers.motion = true;
        const Image image = s.render(4, 1, 0, layers).image;
        EXPECT_NEAR(image.at(17, 16, 4), fixed ? 0 : 0.25 * 6.4, 1e-4);
        EXPECT_NEAR(image.at(17, 16, 5), fixed ? -0.5 * 6.4 : 0, 1e-4);
    }
}

}  // namespace
}  // namespace kadr::test
