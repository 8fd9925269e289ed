// What a shot asks of a GPU's kernels is known before any device sees a frame of it.
#include "render/kernel_set.h"

#include <gmock/gmock.h>

#include "device/embree/frame_facts.h"
#include "kernels/scene/scene_view.h"
#include "render/plain_stage.h"

namespace kadr {
namespace {

using namespace kernels::requirement;
using test::track;

/// A triangle in front of the camera, no lights, black environment.
struct Triangle : test::PlainStage {
    Triangle() {
        geometry().positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        geometry().indices = {0, 1, 2};
    }
    GeometryData& geometry() { return scene.geometries[0]; }
};

/// The set of a shot that some change makes of the plain one; it has all that the devices find in its frames.
KernelSet with(const std::function<void(Triangle&)>& change) {
    Triangle stage;
    change(stage);
    const BoundShot bound = stage.bind();
    const KernelSet set = kernel_set_of(bound);
    for (const int frame : bound.timing().frames)
        for (const SceneSnapshot& part : make_snapshots(bound, bound.sequence().frame(frame)))
            EXPECT_EQ(kernel_requirements_of(stage.scene, part) & ~set.requirements, 0u);
    return set;
}

LightSpec light(LightKind kind) {
    LightSpec light;
    light.id = "key";
    light.kind = kind;
    return light;
}

TEST(KernelSet, HoldsWhatTheShotAsksForAndNothingElse) {
    using kernels::IntegratorKind;
    EXPECT_EQ(with([](Triangle&) {}), (KernelSet{IntegratorKind::path, kTransforms, false}));
    EXPECT_EQ(with([](Triangle& s) { s.shot.render.integrator = Integrator::direct; }),
              (KernelSet{IntegratorKind::direct, kTransforms, false}));
    EXPECT_EQ(with([](Triangle& s) { s.material().base_color_texture.texture = 0; }).requirements, kTransforms | kMaps);
    EXPECT_EQ(with([](Triangle& s) { s.material().unlit = true; }),
              (KernelSet{IntegratorKind::path, kTransforms | kMaps | kSpecials, false}));
    EXPECT_EQ(with([](Triangle& s) { s.material().alpha_mode = kernels::AlphaMode::mask; }),
              (KernelSet{IntegratorKind::path, kTransforms | kMaps | kSpecials, true}));
    EXPECT_EQ(with([](Triangle& s) { s.shot.render.cull_backfaces = true; }),
              (KernelSet{IntegratorKind::path, kTransforms, true}));
    EXPECT_EQ(with([](Triangle& s) {
                  s.geometry().colors.assign(3, {1, 1, 1, 1});
              }).requirements,
              kTransforms | kMaps | kSpecials);
    EXPECT_EQ(with([](Triangle& s) { s.material().emission = {1, 1, 1}; }).requirements, kTransforms | kEmitters);
    EXPECT_EQ(with([](Triangle& s) { s.material().roughness = 0; }).requirements, kTransforms | kMirrors);
    EXPECT_EQ(with([](Triangle& s) { s.material().dielectric_f0 = 0.1f; }).requirements, kTransforms | kIor);
    EXPECT_EQ(with([](Triangle& s) {
                  s.shot.render.fresnel = FresnelKind::exact;
                  s.material().metallic = 0;
              }).requirements,
              kTransforms | kFresnel);
    EXPECT_EQ(with([](Triangle& s) {
                  s.shot.render.fresnel = FresnelKind::exact;
                  s.material().metallic = 1;
              }).requirements,
              kTransforms);
    EXPECT_EQ(with([](Triangle& s) { s.shot.lights = {light(LightKind::area)}; }).requirements,
              kTransforms | kEmitters);
    EXPECT_EQ(with([](Triangle& s) { s.shot.lights = {light(LightKind::point)}; }).requirements, kTransforms);
}

TEST(KernelSet, MeshesThatBendWhileTheShutterIsOpen) {
    EXPECT_EQ(with([](Triangle& s) {
                  s.geometry().targets.push_back({{0}, {{0, 0, 1}}, {}, {}});
                  s.node(s.ball).weights = {0.5};
                  s.animate(s.ball).weights = {track<double>({{0, 0}, {2, 1}})};
              }),
              (KernelSet{kernels::IntegratorKind::path, kTransforms | kDeformation, true}));
}

}  // namespace
}  // namespace kadr
