#include "render/smoke.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/fake_device.h"
#include "render/tiny_shot.h"

namespace kadr {
namespace {

using testing::HasSubstr;

class Smoke : public testing::Test {
protected:
    void SetUp() override {
        fake_device() = {};
        previous_ = std::filesystem::current_path();
        std::filesystem::current_path(folder_.path());
        options_.shots = {write_tiny_shot(folder_.path(), "  frames: out/{name}.{frame:04}.png\n")};
    }
    void TearDown() override { std::filesystem::current_path(previous_); }
    std::vector<SmokeCase> run(bool update = false) {
        options_.update = update;
        return smoke(options_, [](const SmokeCase&) {});
    }
    std::filesystem::path golden(const std::string& frame) const { return folder_.path() / "golden" / ("tiny." + frame + ".png"); }

    TemporaryFolder folder_;
    std::filesystem::path previous_;
    SmokeOptions options_;
};

TEST_F(Smoke, LooksAtFirstMiddleAndLast) {
    const std::vector<SmokeCase> cases = run();
    ASSERT_EQ(cases.size(), 3u);
    EXPECT_EQ(cases[0].frame, 0);
    EXPECT_EQ(cases[1].frame, 2);
    EXPECT_EQ(cases[2].frame, 3);
    for (const SmokeCase& result : cases) EXPECT_TRUE(result.failures.empty()) << result.failures.front();
    EXPECT_FALSE(std::filesystem::exists(folder_.path() / "out")) << "smoke writes no frames";
}

TEST_F(Smoke, BlackFails) {
    fake_device().scale = 0;
    for (const SmokeCase& result : run()) EXPECT_THAT(result.failures, testing::ElementsAre("the image is black"));
}

TEST_F(Smoke, GoldenImagesMatchUntilTheImageChanges) {
    for (const SmokeCase& result : run(true)) EXPECT_TRUE(result.updated);
    EXPECT_TRUE(std::filesystem::exists(golden("0002")));
    for (const SmokeCase& result : run()) {
        EXPECT_TRUE(result.compared);
        EXPECT_LT(result.flip, 1e-4) << "n / 255 in floats, twice: an ulp apart, which the cube root of dark colours enlarges";
        EXPECT_TRUE(result.failures.empty());
    }
    fake_device().scale = 0.5f;
    for (const SmokeCase& result : run()) {
        ASSERT_EQ(result.failures.size(), 1u);
        EXPECT_THAT(result.failures[0], HasSubstr("mean FLIP "));
    }
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "output/smoke/tiny.0000.png")) << "evidence of the failure";
}

TEST_F(Smoke, AShotThatCannotBeReadIsACaseOfItsOwn) {
    options_.shots.push_back("not-there.yaml");
    const std::vector<SmokeCase> cases = run();
    ASSERT_EQ(cases.size(), 4u);
    EXPECT_TRUE(cases[3].bad_input);
    EXPECT_THAT(cases[3].failures.front(), HasSubstr("not-there.yaml"));
}

TEST(Junit, CountsAndEscapes) {
    SmokeCase good, bad;
    good.shot = "a<b>";
    bad.shot = "b";
    bad.frame = 7;
    bad.failures = {"\"x\" & y\x01"};
    EXPECT_EQ(junit_xml({good, bad}),
              "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
              "<testsuite name=\"kadr smoke\" tests=\"2\" failures=\"1\">\n"
              "  <testcase classname=\"a&lt;b&gt;\" name=\"frame 0\" time=\"0.000\">\n"
              "  </testcase>\n"
              "  <testcase classname=\"b\" name=\"frame 7\" time=\"0.000\">\n"
              "    <failure message=\"&quot;x&quot; &amp; y\"/>\n"
              "  </testcase>\n"
              "</testsuite>\n");
}

}  // namespace
}  // namespace kadr
