// The price list: complete, of settings that exist, and without a choice that nobody should take.
#include "shot/prices.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <set>

#include "shot/prices_measured.h"
#include "shot/schema.h"
#include "shot/shot_fixture.h"

namespace kadr {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;

class Prices : public ShotTest {};

TEST_F(Prices, AreOfSettingsThatShotsTake) {
    for (const MeasuredPrice& price : kMeasuredPrices) {
        ShotOverrides overrides;
        overrides.set = {{std::string("render.") + price.key, price.value}};
        EXPECT_FALSE(parse("", overrides).render == parse("").render) << price.key << ": " << price.value << " is the default";
    }
}

TEST_F(Prices, AreListedForEveryNamedChoice) {
    std::set<std::string> listed;
    for (const MeasuredPrice& price : kMeasuredPrices) listed.insert(std::string(price.key) + ": " + price.value);
    for (const char* key : {"integrator", "fresnel", "denoise", "build"}) {
        const FieldSpec& field = *find_field(std::string("render.") + key);
        const std::string fallback = field.fallback;
        for (const Choice& choice : choices_of(field))
            if (choice.built && fallback.find(choice.name) == std::string::npos) {
                EXPECT_THAT(listed, Contains(std::string(key) + ": " + choice.name));
            }
    }
    for (const char* choice : {"robust: true", "motion_frames: 2", "motion_frames: { count: 2, mix: matrix }", "texture_limit: 64 px", "motion_tolerance: 0.5 px", "bounces: 0"})
        EXPECT_THAT(listed, Contains(choice));
}

// tools/bench/prices.py names a choice that is slower and worse on all samples; medians say less, and are what is kept.
TEST_F(Prices, HoldNoChoiceThatIsSlowerAndWorse) {
    for (const MeasuredPrice& price : kMeasuredPrices)
        EXPECT_FALSE(price.cost > 1.05 && price.relmse > 1 && price.flip > 1) << price.key << ": " << price.value;
}

TEST_F(Prices, AreDescribed) {
    const std::string text = describe_schema("prices");
    EXPECT_EQ(text, describe_prices());
    for (const MeasuredPrice& price : kMeasuredPrices) EXPECT_THAT(text, HasSubstr(fmt::format("\n  {:<25} {} ", price.key, price.value)));
    for (const MeasuredShortcut& way : kMeasuredShortcuts) EXPECT_THAT(text, HasSubstr(way.way));
}

}  // namespace
}  // namespace kadr
