// The quality ladder: what a named block fills in, what it replaces, and who wins over it.
#include "shot/quality.h"

#include <gmock/gmock.h>

#include "shot/quality_measured.h"
#include "shot/shot_fixture.h"

namespace kadr {
namespace {

class Quality : public ShotTest {
protected:
    static Shot by_option(const std::string& name, const std::string& lines = "", std::vector<std::pair<std::string, std::string>> set = {}) {
        ShotOverrides overrides;
        overrides.quality = name;
        overrides.set = std::move(set);
        return parse(lines, overrides);
    }
};

TEST_F(Quality, FillsInWhatTheShotDoesNotGive) {
    const RenderSpec render = parse("render: { quality: draft, bounces: 2 }\n").render;
    EXPECT_EQ(render.samples, 4);
    EXPECT_EQ(render.bounces.total, 2);
    EXPECT_EQ(render.motion_tolerance_px, 0.5);
    EXPECT_EQ(parse("render: { quality: draft, samples: { max_error: 0.1 } }\n").render.max_error, 0.1);
}

TEST_F(Quality, OfTheCommandLineReplacesWhatTheShotGives) {
    const RenderSpec render = by_option("preview", "render: { quality: draft, samples: { max_error: 0.1 }, bounces: { total: 9, glossy: 1 }, clamp: { indirect: 3 } }\n").render;
    EXPECT_EQ(render.samples, 16);
    EXPECT_FALSE(render.max_error);
    EXPECT_EQ(render.bounces, (RenderSpec::Bounces{3, 3, 3, 3}));
    EXPECT_EQ(render.motion_tolerance_px, 0.25);
    EXPECT_EQ(render.clamp_indirect, 3);  // the shot's look
    EXPECT_EQ(by_option("reference", "render: { clamp: { indirect: 3 } }\n").render.clamp_indirect, std::nullopt);
}

TEST_F(Quality, LosesAgainstTheRestOfTheCommandLine) {
    EXPECT_EQ(by_option("draft", "", {{"render.bounces", "7"}}).render.bounces.total, 7);
    ShotOverrides overrides;
    overrides.quality = "final";
    overrides.samples = 12;
    EXPECT_EQ(parse("", overrides).render.samples, 12);
    EXPECT_FALSE(parse("", overrides).render.max_error);
    EXPECT_EQ(parse("render: { quality: final }\n", [] { ShotOverrides o; o.max_error = "0.2"; return o; }()).render.max_error, 0.2);
}

TEST_F(Quality, EveryStepIsAShotAndNoneChangesThePictureThatIsMeant) {
    for (const QualityBlock& block : quality_blocks()) {
        const RenderSpec plain = parse("").render, render = by_option(std::string(block.name)).render;
        EXPECT_EQ(render.integrator, plain.integrator) << block.name;
        EXPECT_EQ(render.filter, plain.filter) << block.name;
        EXPECT_EQ(render.seed, plain.seed) << block.name;
    }
}

// The table is measured by tools/bench/quality.py, which says the same of its own figures: a ladder that is not one anymore is
// not committed.
TEST_F(Quality, EachStepCostsMoreAndErrsLessOnEverySample) {
    for (const MeasuredShot& shot : kMeasuredShots)
        for (std::size_t i = 1; i < shot.steps.size(); ++i) {
            EXPECT_GT(shot.steps[i].cpu_s, shot.steps[i - 1].cpu_s) << shot.name << " " << i;
            EXPECT_LT(shot.steps[i].relmse, shot.steps[i - 1].relmse) << shot.name << " " << i;
            EXPECT_LT(shot.steps[i].flip, shot.steps[i - 1].flip) << shot.name << " " << i;
        }
}

TEST_F(Quality, IsDescribedWithWhatItCostsOnEverySample) {
    const std::string text = describe_quality();
    for (const QualityBlock& block : quality_blocks()) EXPECT_THAT(text, ::testing::HasSubstr(block.yaml()));
    for (const MeasuredShot& shot : kMeasuredShots) EXPECT_THAT(text, ::testing::HasSubstr(std::string("\n  ") + shot.name + " "));
}

TEST_F(Quality, IsRefusedWhereThereIsNone) {
    EXPECT_EQ(errors_of(kBase + std::string("render: { quality: fine }\n"), {}),
              "shot.yaml:4:20: error: render.quality is 'fine'\n    render: { quality: fine }\n                       ^~~~\n  expected one of draft, preview, final, reference");
    ShotOverrides overrides;
    overrides.quality = "fien";
    EXPECT_EQ(errors_of(kBase, overrides), "--quality fien: error: render.quality is 'fien'\n  expected one of draft, preview, final, reference");
}

TEST_F(Quality, IsDescribed) {
    const std::string text = describe_schema("quality");
    for (const QualityBlock& block : quality_blocks()) EXPECT_THAT(text, ::testing::HasSubstr(block.yaml()));
}

}  // namespace
}  // namespace kadr
