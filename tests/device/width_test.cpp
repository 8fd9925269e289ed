// One lane and eight lanes: the same pixels, for everything that a scene can hold.
#include <gtest/gtest.h>

#include <string>

#include "device/embree/embree_device.h"
#include "device/varied_scenes.h"

namespace kadr::test {
namespace {

std::string name_of(int width) {
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 1;
    request.width = width;
    return make_device(request).device->name();
}

TEST(Width, EveryPixelIsTheSameInOneLaneAndInEight) {
    if (best_width() < 8) GTEST_SKIP() << "this processor has no AVX2";
    ASSERT_NE(name_of(1).find("1 lane,"), std::string::npos);
    ASSERT_NE(name_of(8).find("8 lanes,"), std::string::npos);
    FilmLayers layers;
    layers.depth = layers.normal = layers.albedo = true;
    for (const auto integrator : {kernels::IntegratorKind::direct, kernels::IntegratorKind::path})
        for (const VariedScene& content : varied_scenes()) {
            SmallScene s = sunlit(integrator);
            content.add(s);
            const SmallScene::Result one = s.render(16, 1, 1, layers);
            // No tolerance: both forms are one source without contraction to fused operations, the order of additions
            // to a path is fixed, and Embree's packets meet what its single rays meet.
            EXPECT_EQ(one.image.pixels, s.render(16, 1, 8, layers).image.pixels) << content.name;
            EXPECT_GT(one.mean(), 0.03) << content.name;  // not black: half the lines of the rolling shutter see little
        }
}

}  // namespace
}  // namespace kadr::test
