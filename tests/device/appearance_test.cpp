// What the device makes of materials that change and of instances that are hidden.
#include <gtest/gtest.h>

#include "device/device.h"
#include "frame/stage.h"

namespace kadr {
namespace {

/// The square [-1, 1]^2 in z = 0, facing +z.
GeometryData unit_square() {
    GeometryData g;
    g.name = "square";
    g.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    g.indices = {0, 1, 2, 0, 2, 3};
    return g;
}

/// A square of 2 m at the origin that fills the view of a camera at (0, 0, 5), under a sun of `lux` along -z; black
/// behind. The integrator is the analytic one.
struct SquareStage : test::Stage {
    static constexpr double kLux = 3;
    SquareStage() {
        scene.geometries[0] = unit_square();
        scene.materials[0].metallic = 0;
        scene.material_names = {"Paint"};
        scene.material_sources.resize(1);
        scene.material_sources[0].index = 0;
        scene.files[0].material_count = 1;
        add_node("square");
        shot.image = {16, 16, 1};
        shot.camera.vertical_fov_rad = Track<double>(0.2);
        shot.render.integrator = Integrator::direct;
        shot.render.samples = 32;
        shot.render.filter = FilterKind::box;
        shot.render.filter_width_px = 1;
        LightSpec sun;
        sun.id = "sun";
        sun.kind = LightKind::directional;
        sun.strength = Track<double>(kLux);
        shot.lights.push_back(sun);
    }
    MaterialSpec& paint() {
        if (shot.scenes[0].materials.empty()) shot.scenes[0].materials.emplace_back().name = "Paint";
        return shot.scenes[0].materials[0];
    }
};

/// One device through all frames of a stage, as a job has it.
class Renderer {
public:
    explicit Renderer(const test::Stage& stage) : stage_(stage), choice_(make_device({"cpu", 1, 0})) { choice_.device->load(stage.scene, nullptr); }

    /// The image of a frame: its parts by their weights.
    Image render(int frame) {
        Film film(stage_.shot.image.width, stage_.shot.image.height, {});
        int first = 0;
        for (const SceneSnapshot& part : stage_.snapshots(frame)) {
            Pass pass;
            pass.first_sample = first;
            pass.sample_count = static_cast<int>(std::lround(part.weight * stage_.shot.render.samples));
            pass.total_samples = stage_.shot.render.samples;
            choice_.device->set_frame(part);
            choice_.device->render(pass, film);
            first += pass.sample_count;
        }
        return film.develop();
    }
    double middle(int frame, int channel) { return render(frame).at(8, 8, channel); }
    DeviceStatistics statistics() const { return choice_.device->statistics(); }

private:
    const test::Stage& stage_;
    DeviceChoice choice_;
};

/// Diffuse radiance of a dielectric of roughness 1 seen and lit head on: under `direct` albedo / pi of what the specular
/// lobe leaves, plus that lobe. Two albedos tell the two apart.
TEST(Appearance, AFadeHasTheAlbedoOfItsTime) {
    SquareStage stage;
    stage.paint().base_color = test::track<glm::dvec3>({{0, {0, 0, 0}}, {32, {1, 0.5, 0.25}}});
    Renderer renderer(stage);
    stage.shot.shutter = {0, 0};
    const double lobe = renderer.middle(0, 0), white = renderer.middle(32, 0);
    EXPECT_NEAR(white - lobe, 0.96 / test::kPi * SquareStage::kLux, 1e-5);  // F0 = 0.04 of a dielectric
    for (const int frame : {4, 16, 31})
        for (int channel = 0; channel < 3; ++channel) {
            const double albedo = frame / 32.0 * glm::dvec3(1, 0.5, 0.25)[channel];
            EXPECT_NEAR(renderer.middle(frame, channel) - lobe, albedo * (white - lobe), 1e-5) << "frame " << frame;  // floats
        }
    stage.shot.shutter = {0, 1};
    EXPECT_NEAR(renderer.middle(16, 0) - lobe, 16.5 / 32 * (white - lobe), 1e-5);
}

TEST(Appearance, AFastFadeHasItsMean) {
    SquareStage stage;
    stage.paint().base_color = test::track<glm::dvec3>({{0, {0, 0, 0}}, {1, {1, 1, 1}}});
    Renderer renderer(stage);
    const double lobe = renderer.middle(-1, 0), white = renderer.middle(1, 0);
    EXPECT_NEAR(renderer.middle(0, 0) - lobe, 0.5 * (white - lobe), 1e-5);
}

TEST(Appearance, HiddenHalfOfTheShutterIsHalfTheCoverage) {
    SquareStage stage;
    stage.shot.environment.visible = false;
    Renderer renderer(stage);
    const double always = renderer.middle(0, 0);
    stage.shot.scenes[0].visible = test::track<double>({{0, 1}, {0.375, 0}}, Interpolation::step);
    const Image image = renderer.render(0);
    EXPECT_FLOAT_EQ(static_cast<float>(image.at(8, 8, 3)), 0.375f);  // alpha: 12 of 32 samples
    EXPECT_NEAR(image.at(8, 8, 0), 0.375 * always, 1e-6);
    EXPECT_EQ(renderer.statistics().flattened_triangles, 0u);  // the last part holds nothing
    EXPECT_EQ(renderer.statistics().instances, 0u);
    EXPECT_NEAR(renderer.middle(-1, 0), always, 1e-6);  // and comes back
}

TEST(Appearance, WhatIsHiddenCastsNoShadow) {
    SquareStage stage;
    const int roof = stage.add_node("roof");
    stage.node(roof).translation = {0, 0, 1};
    stage.node(roof).scale = {4, 4, 4};
    stage.shot.camera.position = Track<glm::dvec3>(glm::dvec3(0, 0, 0.9));
    stage.shot.lights[0].direction = Track<glm::dvec3>(glm::dvec3(0, 0, -1));
    EXPECT_EQ(Renderer(stage).middle(0, 0), 0);
    stage.node(roof).visible = false;
    EXPECT_GT(Renderer(stage).middle(0, 0), 0.5);
}

TEST(Appearance, EmissionThatStartsLightsTheScene) {
    // A panel above a floor: dark at frame 0, a light from frame 1 on; the structures are those of frame 0.
    SquareStage stage;
    stage.shot.lights.clear();
    stage.shot.environment.given = true;
    stage.shot.render.integrator = Integrator::path;
    stage.shot.render.samples = 256;
    stage.shot.render.bounces.total = stage.shot.render.bounces.diffuse = 0;
    stage.scene.materials.push_back(stage.scene.materials[0]);
    stage.scene.material_names.push_back("Panel");
    stage.scene.material_sources.push_back({});
    stage.scene.material_sources[1].index = 1;
    stage.scene.files[0].material_count = 2;
    const int panel = stage.add_node("panel");
    stage.node(panel).translation = {0, 0, 10};
    stage.node(panel).primitives[0].material = 1;
    stage.shot.scenes[0].materials.emplace_back().name = "Panel";
    MaterialSpec& glow = stage.shot.scenes[0].materials[0];
    glow.emissive = Track<glm::dvec3>(glm::dvec3(1));
    glow.emissive_strength = test::track<double>({{0, 0}, {1, 50}}, Interpolation::step);
    stage.shot.shutter = {0, 0};
    Renderer renderer(stage);
    EXPECT_EQ(renderer.middle(0, 0), 0);
    const double lit = renderer.middle(1, 0);
    // 4 m2 of 50 nt at 10 m: about 2 lux (the panel is small), seen as albedo / pi and a rough lobe.
    EXPECT_NEAR(lit, 2.0 * 0.96 / test::kPi, 0.06);
    EXPECT_EQ(renderer.middle(0, 0), 0);
}

}  // namespace
}  // namespace kadr
