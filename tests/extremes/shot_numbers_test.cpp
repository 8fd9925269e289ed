// Every number of a shot file, whatever it is: a clear refusal that names its place, or a picture of finite pixels.
#include <gtest/gtest.h>

#include "base/error.h"
#include "extremes/child.h"
#include "extremes/full_scene.h"
#include "extremes/numbers.h"
#include "extremes/shot_fields.h"
#include "extremes/trial.h"
#include "stress/sun_image.h"

namespace kadr::test {
namespace {

class ShotNumbers : public testing::Test {
protected:
    ShotNumbers() {
        fill_with_everything(file_);
        file_.save_gltf();
        stress::write_sun_image(file_.folder() / "sky.hdr", 0.1, 1);
        std::filesystem::current_path(file_.folder());  // paths of the command line are relative to it
    }
    ~ShotNumbers() override { std::filesystem::current_path(before_); }

    /// The scenes are the same in every shot, but for their places.
    Scene scene() const { return load_scene({{"rig", file_.folder() / "scene.gltf", {}}, {"ground", file_.folder() / "scene.gltf", {}}}); }

    Shot shot_with(const NumberSlot& slot, const std::string& number) const { return parse_shot_text(shot_around_slots(), file_.folder() / "shot.yaml", slot.with(number)); }

    GltfBuilder file_;

private:
    std::filesystem::path before_ = std::filesystem::current_path();
};

std::string described(const NumberSlot& slot, const std::string& number) { return slot.path + "=" + slot.before + number + slot.after; }

TEST_F(ShotNumbers, EveryFieldWithNumbersIsTried) {
    for (const FieldSpec& field : schema_table())
        EXPECT_EQ(has_numbers(field), has_numbers(field) && !slots_of(field).empty()) << field.path << ": add its place to shot_fields.cpp";
}

TEST_F(ShotNumbers, OrdinaryOnesAreTaken) {
    const ChildReport report = in_child([&](ChildLog& log) {
        const Scene shared = scene();
        for (const FieldSpec& field : schema_table())
            for (const NumberSlot& slot : has_numbers(field) ? slots_of(field) : std::vector<NumberSlot>()) {
                log.begin(described(slot, slot.ordinary));
                try {
                    if (const std::string found = flaws_of(shot_with(slot, slot.ordinary), shared); !found.empty()) log.complain(described(slot, slot.ordinary) + ": " + found);
                } catch (const InputError& error) {
                    log.complain(described(slot, slot.ordinary) + ": " + error.what());
                }
            }
    });
    EXPECT_EQ(report.ended, "") << report.last;
    EXPECT_EQ(report.complaints, "");
}

TEST_F(ShotNumbers, AreTakenOrRefusedWithTheirPlace) {
    for (const FieldSpec& field : schema_table()) {
        if (!has_numbers(field)) continue;
        const ChildReport report = in_child([&](ChildLog& log) {
            const Scene shared = scene();
            for (const NumberSlot& slot : slots_of(field))
                for (const char* number : kYamlNumbers) {
                    const std::string what = described(slot, number);
                    log.begin(what);
                    try {
                        if (const std::string found = flaws_of(shot_with(slot, number), shared); !found.empty()) log.complain(what + ": " + found);
                    } catch (const InputError& error) {
                        const std::string text = error.what();
                        if (text.find("--set " + slot.path) == std::string::npos && text.find("shot.yaml") == std::string::npos) log.complain(what + ": a refusal that does not say where: " + text);
                    } catch (const std::exception& error) {
                        log.complain(what + ": an exception that is no refusal: " + error.what());
                    }
                }
        });
        EXPECT_EQ(report.ended, "") << field.path << ": " << report.last;
        EXPECT_EQ(report.complaints, "") << field.path;
        EXPECT_LT(report.peak_memory_bytes, kMostMemory) << field.path;
    }
}

}  // namespace
}  // namespace kadr::test
