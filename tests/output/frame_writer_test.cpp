#include "output/frame_writer.h"

#include <sys/resource.h>
#include <sys/wait.h>

#include <cmath>
#include <csignal>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "output/atomic_file.h"
#include "output/view.h"
#include "output_fixtures.h"

namespace kadr {
namespace {

using test::channel;
using test::message_of;
using test::TemporaryFolder;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAre;

const Metadata kMetadata{{"shot", "pan"}, {"settings", "5e77"}};

ViewSpec srgb_view() { return {}; }

pid_t dead_process() {
    const pid_t child = ::fork();
    if (child == 0) ::_exit(0);
    ::waitpid(child, nullptr, 0);
    return child;
}

TEST(FramePath, FillsInTheFrameNumber) {
    EXPECT_EQ(frame_path("out/a.{frame:04}.png", 12), "out/a.0012.png");
    EXPECT_EQ(frame_path("out/a.{frame}.png", 12), "out/a.12.png");
    EXPECT_EQ(frame_path("{frame:06}/{frame}.exr", 7), "000007/7.exr");
    EXPECT_EQ(frame_path("a.{frame:04}.png", 123456), "a.123456.png");
    EXPECT_EQ(frame_path("a.{frame:04}.png", -5), "a.-0005.png");
    EXPECT_EQ(frame_path("a{b}.png", 1), "a{b}.png");
}

TEST(WriteFrame, CreatesTheFolderAndLeavesNothingElse) {
    const TemporaryFolder folder;
    const auto file = folder / "new/deep/f.0001.png";
    write_frame(file, test::gradient(8, 8), srgb_view(), 8, kMetadata);
    EXPECT_EQ(stored_settings_hash(file), "5e77");
    EXPECT_EQ(std::distance(fs::directory_iterator(file.parent_path()), fs::directory_iterator()), 1);
}

TEST(WriteFrame, PngGoesThroughTheViewAndExrDoesNot) {
    const TemporaryFolder folder;
    const Image image = test::plain_image(4, 4, {"R", "G", "B", "A", "depth.Z"}, {0.25f, 0.5f, 1, 1, 7});
    write_frame(folder / "a.png", image, srgb_view(), 16, kMetadata);
    write_frame(folder / "a.exr", image, srgb_view(), 16, kMetadata);
    const Image png = image_io().read(folder / "a.png"), exr = image_io().read(folder / "a.exr");
    EXPECT_EQ(png.channels, (std::vector<std::string>{"R", "G", "B"}));
    EXPECT_NEAR(png.pixels[0], apply_view(image, srgb_view(), false).pixels[0], 0.5 / 65535);
    EXPECT_EQ(exr.at(3, 3, channel(exr, "R")), 0.25f);
    EXPECT_EQ(exr.at(3, 3, channel(exr, "depth.Z")), 7);
}

TEST(WriteFrame, PngHasAlphaOnlyWhereTheImageIsNotOpaque) {
    const TemporaryFolder folder;
    write_frame(folder / "a.png", test::plain_image(4, 4, {"R", "G", "B", "A"}, {0.25f, 0.25f, 0.25f, 0.5f}), srgb_view(), 8, {});
    EXPECT_EQ(image_io().read(folder / "a.png").channels.size(), 4u);
    write_frame(folder / "a.jpg", test::plain_image(4, 4, {"R", "G", "B", "A"}, {0.25f, 0.25f, 0.25f, 0.5f}), srgb_view(), 8, {});
    EXPECT_EQ(image_io().read(folder / "a.jpg").channels.size(), 3u);
}

TEST(WriteFrame, AFailedWriteLeavesTheOldFrame) {
    const TemporaryFolder folder;
    const auto file = folder / "f.png";
    write_frame(file, test::gradient(8, 8), srgb_view(), 8, kMetadata);
    // The temporary name leads to a device that is always full.
    fs::create_symlink("/dev/full", temporary_name(file));
    EXPECT_EQ(message_of<RenderError>([&] { write_frame(file, test::gradient(8, 8), srgb_view(), 8, {{"settings", "new"}}); }),
              "cannot write '" + file.string() +
                  "': No space left on device; free some space and run the same command again: complete frames are kept");
    EXPECT_EQ(stored_settings_hash(file), "5e77");
    EXPECT_THAT(folder.names(), ElementsAre("f.png"));
}

TEST(WriteFrame, AFileSizeLimitIsAnErrorAndNotTheEnd) {
    const TemporaryFolder folder;
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    const rlimit small{2000, old.rlim_max};
    ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
    const std::string message =
        message_of<RenderError>([&] { write_frame(folder / "f.png", test::gradient(64, 64), srgb_view(), 16, kMetadata); });
    ::setrlimit(RLIMIT_FSIZE, &old);
    EXPECT_EQ(message, "cannot write '" + (folder / "f.png").string() +
                           "': File too large; raise the limit on the size of files (ulimit -f)");
    EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(WriteFrame, AFolderThatCannotBeMadeIsNamed) {
    const TemporaryFolder folder;
    test::write_text(folder / "file", "");
    EXPECT_EQ(message_of<RenderError>([&] { write_frame(folder / "file/sub/f.png", test::gradient(4, 4), srgb_view(), 8, {}); }),
              "cannot create the folder '" + (folder / "file/sub").string() + "': Not a directory");
}

TEST(WriteFrame, AnUnwritableFolderIsNamed) {
    if (::geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
    const TemporaryFolder folder;
    fs::permissions(folder.path(), fs::perms::owner_read | fs::perms::owner_exec);
    EXPECT_EQ(message_of<RenderError>([&] { write_frame(folder / "f.png", test::gradient(4, 4), srgb_view(), 8, {}); }),
              "cannot write '" + (folder / "f.png").string() +
                  "': Permission denied; choose another folder or change its permissions");
    fs::permissions(folder.path(), fs::perms::owner_all);
}

TEST(WriteFrame, AnUnknownExtensionIsBadInput) {
    EXPECT_EQ(message_of<InputError>([] { write_frame("f.bmp", test::gradient(4, 4), srgb_view(), 8, {}); }),
              "error: cannot write 'f.bmp': the format 'bmp' is not known\n  expected .exr, .png, .jpg or .jpeg");
}

TEST(StoredSettings, AreEmptyForWhatIsNotACompleteFrameOfOurs) {
    const TemporaryFolder folder;
    EXPECT_EQ(stored_settings_hash(folder / "absent.png"), "");
    test::write_text(folder / "text.png", "hello");
    EXPECT_EQ(stored_settings_hash(folder / "text.png"), "");
    image_io().write(folder / "foreign.png", "png", test::gradient(4, 4), 8, {});
    EXPECT_EQ(stored_settings_hash(folder / "foreign.png"), "");
    for (const char* name : {"t.exr", "t.png", "t.jpg"}) {
        write_frame(folder / name, test::gradient(64, 64), srgb_view(), 8, kMetadata);
        EXPECT_EQ(stored_settings_hash(folder / name), "5e77") << name;
        fs::resize_file(folder / name, fs::file_size(folder / name) - 1);
        EXPECT_EQ(stored_settings_hash(folder / name), "") << name;
    }
}

TEST(DescribeImage, GivesTheMetadataOrSaysWhyNot) {
    const TemporaryFolder folder;
    write_frame(folder / "a.exr", test::gradient(4, 4), srgb_view(), 8, kMetadata);
    EXPECT_EQ(describe_image(folder / "a.exr"), kMetadata);
    image_io().write(folder / "foreign.png", "png", test::gradient(4, 4), 8, {});
    EXPECT_EQ(message_of<InputError>([&] { describe_image(folder / "foreign.png"); }),
              "error: '" + (folder / "foreign.png").string() +
                  "' says nothing about itself that Kadr knows\n  expected an image that Kadr wrote (.exr, .png or .jpg)");
    EXPECT_EQ(message_of<InputError>([&] { describe_image(folder / "absent.png"); }),
              "error: there is no file '" + (folder / "absent.png").string() + "'\n  expected an image that Kadr wrote");
}

TEST(Leftovers, OfDeadRunsGoAndOthersStay) {
    const TemporaryFolder folder;
    const std::string dead = ".kadr-" + std::to_string(dead_process()) + "-f.0001.tmp.png";
    const std::string ours = temporary_name(folder / "f.0002.png").filename();
    for (const std::string& name : {dead, ours, std::string(".kadr-notes"), std::string(".kadr-99x-f.tmp.png"), std::string("f.0001.png")})
        test::write_text(folder / name, "x");
    remove_leftovers(folder.path());
    EXPECT_THAT(folder.names(), UnorderedElementsAre(ours, ".kadr-notes", ".kadr-99x-f.tmp.png", "f.0001.png"));
}

TEST(Leftovers, FromBeforeAReusedProcessNumberGo) {
    const TemporaryFolder folder;
    const auto old = temporary_name(folder / "f.png");
    test::write_text(old, "x");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(24 * 365));
    remove_leftovers(folder.path());
    EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(Leftovers, InAFolderThatDoesNotExistAreNone) { EXPECT_NO_THROW(remove_leftovers("/nonexistent/kadr")); }

}  // namespace
}  // namespace kadr
