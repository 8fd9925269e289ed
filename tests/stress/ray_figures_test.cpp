#include "stress/ray_figures.h"

#include <cmath>

#include <gtest/gtest.h>

#include "device/exact/exact_device.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"
#include "shot/shot_parser.h"
#include "stress/axis.h"

namespace kadr::stress {
namespace {

/// Answers of another device, changed as a fault would.
class FaultyDevice final : public Device, private Probe {
public:
    explicit FaultyDevice(Device& device) : device_(device) {}
    std::string name() const override { return "faulty"; }
    void load(const Scene&, const Image*, const BuildSettings&) override {}
    void set_frame(const SceneSnapshot&) override {}
    void render(const Pass&, Film&) override {}
    DeviceStatistics statistics() const override { return {}; }
    Probe* probe() override { return this; }

    double shift_m = 0;          ///< of what camera rays meet
    int miss_every = 0;          ///< camera rays that pass through; 0: none
    int wrong_every = 0;         ///< shadow rays with the wrong answer; 0: none
    int wrong_light_every = 0;   ///< rays to lights with the wrong answer; 0: none

private:
    std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) override {
        std::vector<SurfaceHit> hits = device_.probe()->look(film_px, time);
        for (std::size_t i = 0; i < hits.size(); ++i) {
            hits[i].position.x += shift_m;
            if (miss_every > 0 && i % static_cast<std::size_t>(miss_every) == 0) hits[i] = {};
        }
        return hits;
    }
    std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) override {
        std::vector<char> answers = device_.probe()->occluded(rays, time);
        for (std::size_t i = 0; wrong_every > 0 && i < answers.size(); i += static_cast<std::size_t>(wrong_every)) answers[i] = !answers[i];
        return answers;
    }

    int light_count() const override { return device_.probe()->light_count(); }
    std::vector<LightSight> towards_lights(std::span<const LightRay> rays, double time) override {
        std::vector<LightSight> sights = device_.probe()->towards_lights(rays, time);
        for (std::size_t i = 0; wrong_light_every > 0 && i < sights.size(); i += static_cast<std::size_t>(wrong_light_every))
            if (sights[i] != LightSight::not_towards) sights[i] = sights[i] == LightSight::seen ? LightSight::hidden : LightSight::seen;
        return sights;
    }

    Device& device_;
};

/// An ordinary cell of the sweep, given to the reference and to a device that answers as it does.
class RayFiguresTest : public testing::Test {
protected:
    RayFiguresTest()
        : loaded_(parse_shot(write_shot(axis_of("distance"), 0, testing::TempDir() + "kadr-ray-figures"))),
          reference_(make_exact_device(loaded_.bound())), faulty_(*reference_) {
        load_device(*reference_, loaded_);
        snapshot_ = make_snapshots(loaded_.bound(), loaded_.bound().sequence().frame(0)).front();
        reference_->set_frame(snapshot_);
    }
    RayFigures figures() { return compare_rays(faulty_, *reference_, snapshot_, {1, 4}); }

    LoadedShot loaded_;
    std::unique_ptr<Device> reference_;
    FaultyDevice faulty_;
    SceneSnapshot snapshot_;
};

TEST_F(RayFiguresTest, NothingIsWrongWithTheReferenceItself) {
    const RayFigures f = figures();
    EXPECT_EQ(f.errors(), 0u);
    EXPECT_EQ(f.position_error_px, 0);
    EXPECT_GT(f.camera_rays, 2000u);  // of 2304: the others are near edges
    EXPECT_GT(f.shadow_rays, 6000u);
    EXPECT_GT(f.light_rays, 3000u);
}

TEST_F(RayFiguresTest, HolesAreCounted) {
    faulty_.miss_every = 10;
    const RayFigures f = figures();
    EXPECT_NEAR(static_cast<double>(f.holes) / static_cast<double>(f.camera_rays), 0.1, 0.03);
    EXPECT_EQ(f.false_shadows + f.leaks, 0u);
}

TEST_F(RayFiguresTest, WrongAnswersOfShadowRaysAreFalseShadowsAndLeaks) {
    faulty_.wrong_every = 20;
    const RayFigures f = figures();
    EXPECT_NEAR(static_cast<double>(f.false_shadows + f.leaks) / static_cast<double>(f.shadow_rays), 0.05, 0.01);
    EXPECT_GT(f.false_shadows, 10u);
    EXPECT_GT(f.leaks, 10u);
    EXPECT_EQ(f.holes, 0u);
}

TEST_F(RayFiguresTest, WrongAnswersOfRaysToLightsCountAsWell) {
    faulty_.wrong_light_every = 20;
    const RayFigures f = figures();
    EXPECT_NEAR(static_cast<double>(f.false_shadows + f.leaks) / static_cast<double>(f.light_rays), 0.05, 0.01);
    EXPECT_GT(f.false_shadows, 10u);
    EXPECT_GT(f.leaks, 5u);  // few of these rays are hidden
}

TEST_F(RayFiguresTest, ErrorsOfPlacesAreInPixels) {
    faulty_.shift_m = 1e-3;
    // The picture shows some 7 m in 64 pixels; across the ray, the shift is between nothing and all of it.
    const double px = figures().position_error_px;
    EXPECT_GT(px, 0.3e-3 * 64 / 7);
    EXPECT_LT(px, 3e-3 * 64 / 7);
}

/// The program's device and the reference take the same samples: their pictures differ by rounding alone.
TEST(ExactDevice, HasThePictureOfTheProcessorsDevice) {
    for (const char* axis : {"distance", "metallic", "sun_diameter", "sun_contrast", "area_side", "spot_edge", "spin", "shutter"}) {
        const LoadedShot loaded(parse_shot(write_shot(axis_of(axis), axis_of(axis).ordinary, testing::TempDir() + "kadr-exact")));
        const auto render = [&](Device& device) {
            load_device(device, loaded);
            return FrameRenderer(device).render(loaded.bound(), loaded.bound().sequence().frame(0), {}).image;
        };
        const std::unique_ptr<Device> reference = make_exact_device(loaded.bound());
        const Image exact = render(*reference), is = render(*make_device({"cpu", 2, 0}).device);
        std::size_t apart = 0;
        double mean = 0;
        for (std::size_t i = 0; i < is.pixels.size(); ++i) {
            // A path that takes another turn at an edge is off by much; all others by the rounding of some hundred operations.
            apart += std::abs(is.pixels[i] - exact.pixels[i]) > 1e-3f * (1 + exact.pixels[i]) ? 1 : 0;
            mean += exact.pixels[i];
        }
        EXPECT_LT(apart, is.pixels.size() / 500) << axis;
        EXPECT_GT(mean / static_cast<double>(is.pixels.size()), 0.05) << axis;
    }
}

/// A camera of a glTF file does not say what it looks at, and through a long lens that has to be known.
TEST(RenderSpace, LiesAboutWhatAnAuthoredLongLensShows) {
    const LoadedShot loaded(parse_shot(write_shot(axis_of("authored_telephoto"), 1e4, testing::TempDir() + "kadr-lens")));
    const SceneSnapshot snapshot = make_snapshots(loaded.bound(), loaded.bound().sequence().frame(0)).front();
    constexpr double kHalfHeight_m = 0.65;  // of what it shows: a ball of 2 m fills the picture
    EXPECT_LE(glm::length(snapshot.render_origin - glm::dvec3(0, 1.05, 0)), 256 * kHalfHeight_m);
}

/// Devices measure in the units of a frame; files hold metres.
TEST(RenderSpace, DepthIsInMetresWhateverTheUnitIs) {
    FilmLayers layers;
    layers.depth = true;
    const auto depths_of = [&](double scale) {
        const LoadedShot loaded(parse_shot(write_shot(axis_of("scale"), scale, testing::TempDir() + "kadr-depth")));
        const DeviceChoice choice = make_device({"cpu", 2, 0});
        load_device(*choice.device, loaded);
        FrameRequest request;
        request.layers = layers;
        const Image image = FrameRenderer(*choice.device).render(loaded.bound(), loaded.bound().sequence().frame(0), request).image;
        EXPECT_EQ(image.channels.at(4), "depth.Z");
        std::vector<double> depths;
        for (std::size_t i = 4; i < image.pixels.size(); i += image.channels.size()) depths.push_back(image.pixels[i]);
        return depths;
    };
    const std::vector<double> ordinary = depths_of(1), tiny = depths_of(1e-6);
    ASSERT_EQ(ordinary.size(), tiny.size());
    std::size_t apart = 0;
    for (std::size_t i = 0; i < tiny.size(); ++i) apart += std::abs(tiny[i] * 1e6 / ordinary[i] - 1) > 1e-4 ? 1 : 0;
    EXPECT_LT(apart, tiny.size() / 100);  // of pixels at edges, where a sample may meet the other side
}

}  // namespace
}  // namespace kadr::stress
