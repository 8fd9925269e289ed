// Frames on their way: evaluated ahead, handed out to devices, delivered in their order.
#include "render/frame_schedule.h"

#include <atomic>
#include <chrono>

#include <gtest/gtest.h>

#include "base/error.h"
#include "render/render_job.h"

namespace kadr {
namespace {

using Task = FrameSchedule::Task;

/// A frame that has something to render.
Task frame_with_parts(std::size_t index) {
    auto task = std::make_shared<FrameTask>();
    task->index = index;
    task->time.number = static_cast<int>(index);
    task->parts = std::make_shared<const std::vector<SceneSnapshot>>(1);
    return task;
}

void finish(const Task& task) { task->promise.set_value(nullptr); }

TEST(FrameSchedule, NoMoreFramesAreEvaluatedThanDevicesCanTake) {
    std::atomic<int> evaluated{0};
    FrameSchedule schedule(100, 2, [&](std::size_t index) {
        ++evaluated;
        return frame_with_parts(index);
    });
    schedule.at(0);
    while (evaluated < 2) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(evaluated, 2);  // one for each device
    EXPECT_EQ(schedule.take(0)->index, 0u);
    while (evaluated < 3) std::this_thread::yield();
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_EQ(evaluated, 3);
}

TEST(FrameSchedule, ADeviceGetsWhatItLookedAhead) {
    FrameSchedule schedule(4, 2, frame_with_parts);
    std::shared_ptr<const SceneSnapshot> first, second;
    while (!(first = schedule.look_ahead(0))) std::this_thread::yield();
    while (!(second = schedule.look_ahead(1))) std::this_thread::yield();
    EXPECT_NE(first, second);
    EXPECT_EQ(schedule.look_ahead(0), first);  // it keeps to it
    const Task one = schedule.take(1), zero = schedule.take(0);
    EXPECT_EQ(one->index, 1u);
    EXPECT_EQ(&one->parts->front(), second.get());
    EXPECT_EQ(zero->index, 0u);
}

TEST(FrameSchedule, WhoIsFreeTakesWhatAnotherLookedAtBeforeItIsIdle) {
    FrameSchedule schedule(1, 2, frame_with_parts);
    while (!schedule.look_ahead(0)) std::this_thread::yield();
    EXPECT_EQ(schedule.take(1)->index, 0u);
    EXPECT_EQ(schedule.look_ahead(0), nullptr);
    EXPECT_EQ(schedule.take(0), nullptr);
}

TEST(FrameSchedule, AnErrorComesWhenItIsThatFramesTurn) {
    FrameSchedule schedule(4, 1, [](std::size_t index) {
        if (index == 2) throw InputError("half a turn");
        return frame_with_parts(index);
    });
    for (std::size_t index = 0; index < 2; ++index) {
        EXPECT_EQ(schedule.at(index)->index, index);
        finish(schedule.take(0));
        schedule.delivered();
    }
    EXPECT_THROW(schedule.at(2), InputError);
    EXPECT_EQ(schedule.take(0), nullptr);
}

TEST(FrameSchedule, FinishedFramesDoNotPileUp) {
    FrameSchedule schedule(100, 1, frame_with_parts);
    finish(schedule.take(0));
    finish(schedule.take(0));
    std::atomic<bool> taken{false};
    std::thread device([&] {
        finish(schedule.take(0));
        taken = true;
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    EXPECT_FALSE(taken);  // two wait for the delivery
    schedule.at(0);
    schedule.delivered();
    device.join();
}

TEST(FrameSchedule, ASlowFrameDoesNotHoldUpOtherDevices) {
    FrameSchedule schedule(100, 2, frame_with_parts);
    const Task slow = schedule.take(0);
    for (std::size_t i = 1; i < 8; ++i) {
        const Task quick = schedule.take(1);
        EXPECT_EQ(quick->index, i);
        finish(quick);
    }
    finish(slow);
}

TEST(FrameSchedule, WhatRepeatsOrIsReusedIsNotHandedOut) {
    FrameSchedule schedule(1000, 1, [](std::size_t index) {
        if (index == 500) return frame_with_parts(index);
        auto task = std::make_shared<FrameTask>();
        task->index = index;
        task->reused = true;
        return task;
    });
    for (std::size_t index = 0; index < 500; ++index) {
        EXPECT_TRUE(schedule.at(index)->reused);
        schedule.delivered();
    }
    EXPECT_EQ(schedule.take(0)->index, 500u);
}

TEST(FrameSchedule, WhoWaitsForAFrameThatNobodyTookIsToldWhy) {
    FrameSchedule schedule(3, 2, frame_with_parts);
    const Task waiting = schedule.at(0);
    schedule.stop(std::make_exception_ptr(RenderError("a device fell over")));
    EXPECT_THROW(waiting->rendered.get(), RenderError);
    EXPECT_EQ(schedule.take(0), nullptr);
    EXPECT_EQ(schedule.look_ahead(0), nullptr);
}

TEST(FrameSchedule, AnInterruptIsHeardWhileAFrameIsEvaluated) {
    std::atomic<bool> go_on{false};
    FrameSchedule schedule(1, 1, [&](std::size_t index) {
        while (!go_on) std::this_thread::yield();
        return frame_with_parts(index);
    });
    interrupt_requested() = true;
    EXPECT_THROW(schedule.at(0), Interrupted);
    interrupt_requested() = false;
    go_on = true;
}

}  // namespace
}  // namespace kadr
