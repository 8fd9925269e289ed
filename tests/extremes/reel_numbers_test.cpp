// Every number of a reel file, whatever it is: a clear refusal that names its place, or a plan of bounded size.
#include <gtest/gtest.h>

#include "base/error.h"
#include "extremes/child.h"
#include "extremes/full_scene.h"
#include "extremes/numbers.h"
#include "extremes/shot_fields.h"
#include "render/reel_plan.h"
#include "shot/reel.h"

namespace kadr::test {
namespace {

class ReelNumbers : public testing::Test {
protected:
    ReelNumbers() {
        fill_with_everything(file_);
        file_.save_gltf();
        std::string shot = shot_around_slots();
        shot.replace(shot.find("frames: 12"), 10, "frames: 0-47");
        file_.save_text("shot.yaml", shot);
        file_.save_text("sound.wav", "sound");
        file_.save_text("reel.yaml", reel_around_slots());
        std::filesystem::current_path(file_.folder());
    }
    ~ReelNumbers() override { std::filesystem::current_path(before_); }

    /// "" where the reel can be planned, else what is said of it. Sound is read and not planned: that asks ffmpeg every time.
    std::string refusal_of(const NumberSlot& slot, const std::string& number) const {
        try {
            if (slot.path == "reel.sound") parse_reel("reel.yaml", slot.with(number));
            else plan_reel("reel.yaml", slot.with(number));
        } catch (const InputError& error) {
            return error.what();
        }
        return {};
    }

    GltfBuilder file_;

private:
    std::filesystem::path before_ = std::filesystem::current_path();
};

TEST_F(ReelNumbers, OrdinaryOnesAreTaken) {
    const ChildReport report = in_child([&](ChildLog& log) {
        for (const FieldSpec& field : reel_table())
            for (const NumberSlot& slot : has_numbers(field) ? slots_of(field) : std::vector<NumberSlot>())
                if (const std::string found = refusal_of(slot, slot.ordinary); !found.empty()) log.complain(slot.with(slot.ordinary).set[0].second + ": " + found);
    });
    EXPECT_EQ(report.ended, "") << report.last;
    EXPECT_EQ(report.complaints, "");
}

TEST_F(ReelNumbers, AreTakenOrRefusedWithTheirPlace) {
    for (const FieldSpec& field : reel_table()) {
        if (!has_numbers(field)) continue;
        EXPECT_FALSE(slots_of(field).empty()) << field.path << ": add its place to shot_fields.cpp";
        const ChildReport report = in_child([&](ChildLog& log) {
            for (const NumberSlot& slot : slots_of(field))
                for (const char* number : kYamlNumbers) {
                    log.begin(slot.path + " = " + number);
                    const std::string found = refusal_of(slot, number);
                    if (!found.empty() && found.find("--set " + slot.path) == std::string::npos && found.find(".yaml:") == std::string::npos) log.complain(slot.path + " = " + number + ": " + found);
                }
        });
        EXPECT_EQ(report.ended, "") << field.path << ": " << report.last;
        EXPECT_EQ(report.complaints, "") << field.path;
        EXPECT_LT(report.peak_memory_bytes, kMostMemory) << field.path;
    }
}

}  // namespace
}  // namespace kadr::test
