#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/bounded_queue.h"
#include "render/delivery.h"
#include "render/image_checks.h"
#include "render/loaded_shot.h"
#include "render/output_plan.h"

namespace kadr {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(BoundedQueue, KeepsTheOrderAndHoldsTheProducerBack) {
    BoundedQueue<int> queue(2);
    std::atomic<int> pushed{0};
    std::thread producer([&] {
        for (int i = 0; i < 100; ++i) {
            queue.push(i);
            ++pushed;
        }
        queue.close();
    });
    int expected = 0;
    while (const std::optional<int> item = queue.pop()) {
        EXPECT_EQ(*item, expected++);
        EXPECT_LE(pushed.load(), expected + 3);  // two inside, one being pushed
    }
    producer.join();
    EXPECT_EQ(expected, 100);
}

TEST(BoundedQueue, TakesNothingOnceClosed) {
    BoundedQueue<int> queue(1);
    queue.push(7);
    queue.close();
    EXPECT_FALSE(queue.push(8));
    EXPECT_EQ(queue.pop(), 7);
    EXPECT_EQ(queue.pop(), std::nullopt);
}

TEST(VideoSource, PrefersLosslessDisplayValues) {
    EXPECT_EQ(video_source({"a.exr", "a.jpg", "a.png"}), "a.png");
    EXPECT_EQ(video_source({"a.exr", "a.jpg"}), "a.jpg");
    EXPECT_EQ(video_source({"a.exr"}), "a.exr");
}

TEST(LimitedWidth, KeepsTheAspect) {
    ImageSpec image;
    image.width = 1280;
    image.height = 720;
    EXPECT_EQ(limited_width(image, 640).width, 640);
    EXPECT_EQ(limited_width(image, 640).height, 360);
    image.width = 4000;
    image.height = 1;
    EXPECT_EQ(limited_width(image, 160).height, 1);
    image.width = image.height = 100;
    EXPECT_EQ(limited_width(image, 640), image);
}

Image rgb(std::vector<float> pixels) { return {static_cast<int>(pixels.size() / 3), 1, {"R", "G", "B"}, std::move(pixels)}; }

TEST(ObviousFaults, FindsEachKind) {
    EXPECT_THAT(obvious_faults(rgb({0, 0.5f, 0, 1, 0, 0})), ElementsAre());
    EXPECT_THAT(obvious_faults(rgb({0, 0, 0, 0, 0, 0})), ElementsAre("the image is black"));
    EXPECT_THAT(obvious_faults(rgb({1, 2, 3, 1, 2, 3})), ElementsAre("every pixel has the same colour"));
    EXPECT_THAT(obvious_faults(rgb({1, NAN, 3, 1, 2, 3})), ElementsAre("1 values are not finite"));
    EXPECT_THAT(obvious_faults(rgb({1, -1, 3, 1, 2, 3})), ElementsAre("a colour is negative (-1)"));
}

TEST(OutputPlan, SeveralFramesNeedSeveralFiles) {
    OutputSpec output;
    output.frames = {"/tmp/a.{frame:04}.png", "/tmp/still.png"};
    const std::vector<Diagnostic> problems = colliding_patterns(output, {0, 1, 2});
    ASSERT_EQ(problems.size(), 1u);
    EXPECT_EQ(problems[0].found, "output.frames gives 3 frames one file, /tmp/still.png");
    EXPECT_EQ(problems[0].expected, "write the frame's number as {frame:04}");
    EXPECT_TRUE(colliding_patterns(output, {5}).empty());
}

TEST(OutputPlan, AFileIsNoFolder) {
    EXPECT_EQ(why_not_writable("/dev/null/frames"), "/dev/null is not a folder");
    EXPECT_EQ(why_not_writable("/tmp/not-there-yet/frames"), "");
    EXPECT_THROW(prepare_folders({"/dev/null/frames"}), RenderError);
}

}  // namespace
}  // namespace kadr
