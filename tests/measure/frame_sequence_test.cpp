#include "measure/frame_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/output_fixtures.h"

namespace kadr {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;

void touch(const TemporaryFolder& folder, const std::vector<std::string>& names) {
    for (const std::string& name : names) {
        fs::create_directories((folder / name).parent_path());
        test::write_text(folder / name, "");
    }
}

FrameSequence find(const TemporaryFolder& folder, const std::string& name) {
    return find_frames((folder / name).string());
}

std::vector<int> numbers_of(const FrameSequence& sequence) {
    std::vector<int> numbers;
    for (const FrameFile& file : sequence.files) numbers.push_back(file.number.value_or(-1000));
    return numbers;
}

std::vector<std::string> labels_of(const std::vector<FramePair>& pairs) {
    std::vector<std::string> labels;
    for (const FramePair& pair : pairs) labels.push_back(pair.label);
    return labels;
}

TEST(FindFrames, SortsNumbersAsNumbers) {
    const TemporaryFolder folder;
    touch(folder, {"a.10.png", "a.9.png", "a.100.png", "notes.txt", ".hidden.1.png"});
    EXPECT_THAT(numbers_of(find(folder, "")), ElementsAre(9, 10, 100));
}

TEST(FindFrames, TakesEveryUsualPattern) {
    const TemporaryFolder folder;
    touch(folder, {"v2.0001.exr", "v2.0002.exr", "v2.0002.png", "v3.0001.exr", "v2.0001.exr.tmp"});
    for (const char* pattern : {"v2.{frame:04}.exr", "v2.{frame}.exr", "v2.%04d.exr", "v2.####.exr"})
        EXPECT_THAT(numbers_of(find(folder, pattern)), ElementsAre(1, 2)) << pattern;
}

TEST(FindFrames, SaysWhatIsNotThere) {
    const TemporaryFolder folder;
    touch(folder, {"notes.txt", "empty/notes.txt"});
    const auto message = [&](const std::string& name) {
        return test::message_of<InputError>([&] { find(folder, name); });
    };
    EXPECT_THAT(message("missing.png"), HasSubstr("there is no file or folder"));
    EXPECT_THAT(message("notes.txt"), HasSubstr("is not an image"));
    EXPECT_THAT(message("empty"), HasSubstr("there is no image in the folder"));
    EXPECT_THAT(message("a.####.png"), HasSubstr("no file matches"));
    EXPECT_THAT(message("a.##.%04d.png"), HasSubstr("has 2 places for the frame's number"));
    EXPECT_THAT(message("nowhere/a.####.png"), HasSubstr("cannot list the folder"));
}

TEST(PairFrames, PairsSeriesOfAnyNameByNumber) {
    const TemporaryFolder folder;
    touch(folder, {"a/old.1.exr", "a/old.2.exr", "b/new_0002.png", "b/new_0001.png"});
    const std::vector<FramePair> pairs = pair_frames(find(folder, "a"), find(folder, "b"), {});
    EXPECT_THAT(labels_of(pairs), ElementsAre("1", "2"));
    EXPECT_EQ(pairs[1].reference.filename(), "old.2.exr");
    EXPECT_EQ(pairs[1].test.filename(), "new_0002.png");
}

TEST(PairFrames, PairsFoldersOfManySeriesByName) {
    const TemporaryFolder folder;
    touch(folder, {"a/pan.1.png", "a/spin.1.png", "a/title.png", "b/pan.1.exr", "b/spin.1.exr", "b/title.exr"});
    EXPECT_THAT(labels_of(pair_frames(find(folder, "a"), find(folder, "b"), {})),
                ElementsAre("pan.1", "spin.1", "title"));
}

TEST(PairFrames, ComparesOnlyTheFramesAskedFor) {
    const TemporaryFolder folder;
    touch(folder, {"a/x.1.png", "a/x.2.png", "a/x.3.png", "b/x.2.png", "b/x.3.png", "b/x.4.png"});
    EXPECT_THAT(labels_of(pair_frames(find(folder, "a"), find(folder, "b"), {2, 3})), ElementsAre("2", "3"));
}

TEST(PairFrames, LeavesNothingOut) {
    const TemporaryFolder folder;
    touch(folder, {"a/x.1.png", "a/x.2.png", "b/x.2.png", "b/x.3.png", "c/x.2.png", "c/x.2.exr", "one.png"});
    const auto message = [&](const std::string& a, const std::string& b, const std::vector<int>& frames) {
        return test::message_of<InputError>([&] { pair_frames(find(folder, a), find(folder, b), frames); });
    };
    EXPECT_THAT(message("a", "b", {}), HasSubstr("lacks frame 3"));
    EXPECT_THAT(message("a", "b", {}), HasSubstr("lacks frame 1"));
    EXPECT_THAT(message("a", "b", {2, 7, 8}), HasSubstr("has frames 7, 8"));
    EXPECT_THAT(message("c", "b", {2}), HasSubstr("are the same frame"));
    EXPECT_THAT(message("one.png", "b", {}), HasSubstr("is one image"));
}

}  // namespace
}  // namespace kadr
