// Whether structures are built as the shot asks. Embree tells their flags, not their quality.
#include <gtest/gtest.h>

#include "device/embree/embree_scene.h"
#include "device/small_scene.h"

namespace kadr {
namespace {

using namespace test;

TEST(Structures, AreRobustWhereTheShotAsksForIt) {
    SmallScene s;
    const unsigned square = s.add_mesh(unit_square());
    s.add_instance(square, material({1, 1, 1}, 0, 1), glm::dmat4(1));
    glm::dmat4 later(1);
    later[3][0] = 1;
    s.add_moving(square, material({1, 1, 1}, 0, 1), {glm::dmat4(1), later});
    const EmbreeDeviceHandle device(rtcNewDevice("threads=1"));
    using Robust = BuildSettings::Robust;
    for (const Robust robust : {Robust::no, Robust::wanted, Robust::required}) {
        EmbreeScene scene(device.get(), s.scene, nullptr, {BuildQuality::high, robust});
        scene.set_frame(s.snapshot);
        ASSERT_NE(scene.flat(), nullptr);
        ASSERT_NE(scene.instanced(), nullptr);
        for (const RTCScene structure : {scene.flat(), scene.instanced()})
            EXPECT_EQ((rtcGetSceneFlags(structure) & RTC_SCENE_FLAG_ROBUST) != 0, robust != Robust::no);
    }
}

}  // namespace
}  // namespace kadr
