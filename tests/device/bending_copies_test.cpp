// Copies of a bending mesh at other times of its clip, pixel by pixel.
#include <gtest/gtest.h>

#include <cmath>

#include "device/rendered_frame.h"

namespace kadr::test {
namespace {

/// A square of two joints, seen with its motion layer; the right half swings about +y and a morph target stretches the top.
struct SwingStage : GlowingStage {
    explicit SwingStage(Skinning skinning) {
        size(48, 48, 2);
        GeometryData& square = scene.geometries[0];
        MorphTarget stretch;
        for (const kernels::Vec3f& p : square.positions) {
            square.skin.joints.push_back(p.x > 0 ? 1 : 0);
            square.skin.weights.push_back(1);
            stretch.positions.push_back({0, p.y > 0 ? 0.5f : 0.0f, 0});
        }
        square.skin.per_vertex = 1;
        square.targets.push_back(stretch);
        scene.materials[0].double_sided = true;
        const int mesh = add_node("Square"), root = add_node("Root", -1, false), half = add_node("Half", root, false);
        Skin skin;
        skin.joints = {root, half};
        skin.inverse_bind = {glm::dmat4(1), glm::dmat4(1)};
        skin.root = root;
        scene.skins.push_back(skin);
        node(mesh).skin = 0;
        node(mesh).weights = {0};
        shot.scenes[0].skinning = skinning;
        animate(half).rotation = track<glm::dquat>({{0, turn(0, {0, 1, 0})}, {1, turn(80, {0, 1, 0})}, {2, turn(0, {0, 1, 0})}});
        animate(mesh).weights = {track<double>({{0, 0.0}, {1.5, 1.0}})};
        shot.timing.fps = {4, 1};
        shot.output.aovs = {Aov::motion};
    }
    void copies(const std::vector<PlacementSpec>& places) {
        shot.scenes[0].instances = InstancesSpec{};
        shot.scenes[0].instances->list = places;
    }
};

PlacementSpec at(double offset_s, double x = 0) {
    PlacementSpec place;
    place.offset_s = offset_s;
    place.translate_m = {x, 0, 0};
    return place;
}

FilmLayers with_motion() {
    FilmLayers layers;
    layers.motion = true;
    return layers;
}

double difference(const Image& a, const Image& b, int first_column = 0) {
    double worst = 0;
    for (int y = 0; y < a.height; ++y)
        for (int x = first_column; x < a.width; ++x)
            for (int c = 0; c < static_cast<int>(a.channels.size()); ++c) worst = std::max<double>(worst, std::abs(a.at(x, y, c) - b.at(x, y, c)));
    return worst;
}

TEST(BendingCopies, LookAsASceneThatStartsAtTheirOffset) {
    for (const Skinning skinning : {Skinning::linear, Skinning::dual_quaternion})
        for (const double offset : {0.25, 0.625}) {
            SwingStage copied(skinning), alone(skinning);
            copied.copies({at(offset)});
            alone.shot.scenes[0].layers[0].start_s = offset;
            for (const int frame : {0, 1}) {
                const Image image = render_frame(copied, 16, frame, with_motion());
                EXPECT_EQ(difference(image, render_frame(alone, 16, frame, with_motion())), 0) << offset << ", frame " << frame;
                copied.copies({at(0)});
                EXPECT_GT(difference(image, render_frame(copied, 16, frame, with_motion())), 0.3);
                copied.copies({at(offset)});
            }
        }
}

TEST(BendingCopies, OfManyOffsetsEachPlayTheirOwn) {
    // The second copy stands where the whole image sees it; the others are beside it.
    SwingStage many(Skinning::linear), alone(Skinning::linear);
    many.copies({at(0, -40), at(0.5), at(1.25, 40)});
    alone.copies({at(0.5)});
    // Vertices are normalised by the bounds of all copies: edges move by the rounding of floats.
    EXPECT_LT(difference(render_frame(many, 16, 1, with_motion()), render_frame(alone, 16, 1, with_motion())), 1e-3);
}

}  // namespace
}  // namespace kadr::test
