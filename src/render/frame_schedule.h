#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "render/frame_task.h"

namespace kadr {

/// The frames of a render in their order: evaluated ahead by a thread of its own, handed out to the devices, and
/// followed by whoever delivers them. As many frames as there are devices are evaluated and wait for one, no more:
/// snapshots can be large.
class FrameSchedule {
public:
    using Task = std::shared_ptr<FrameTask>;

    /// @param evaluate  called by another thread, in order
    FrameSchedule(std::size_t frames, std::size_t devices, std::function<Task(std::size_t index)> evaluate);
    /// Waits for the frame that is being evaluated.
    ~FrameSchedule();
    FrameSchedule(const FrameSchedule&) = delete;
    FrameSchedule& operator=(const FrameSchedule&) = delete;

    // For the devices, from any thread.
    /// The next frame for a device: the one that it looked ahead at where it is still there, else the first that no
    /// other has its eye on, else any. Waits for one; holds devices back that are far ahead of the delivery.
    /// @return null: there are no more
    Task take(std::size_t device);
    /// The first part of what take() is likely to give the device next; null: nothing is known yet. Does not wait.
    std::shared_ptr<const SceneSnapshot> look_ahead(std::size_t device);
    /// Nothing more is evaluated or handed out; who waits for a frame that no device has taken is told why.
    void stop(const std::exception_ptr& why);

    // For the delivery, from one thread.
    /// A frame, as soon as it is evaluated. @pre those before it were delivered
    /// @throws what its evaluation threw; Interrupted
    Task at(std::size_t index);
    /// The first frame that was not delivered is.
    void delivered();
    /// Those that are evaluated and were not delivered, in order.
    std::deque<Task> left() const;

private:
    void evaluate_all(std::size_t frames);
    std::deque<Task>::iterator choose(std::size_t device);
    bool has_its_eye_on(std::size_t device, const Task& task) const;
    bool is_free(const Task& task) const;  ///< no device has its eye on it
    bool is_wanted(const Task& task) const { return task->index < delivered_ + most_ahead_; }

    const std::size_t devices_, most_ahead_;
    const std::function<Task(std::size_t)> evaluate_;
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Task> evaluated_;             ///< that were not delivered
    std::deque<Task> waiting_;               ///< of them, what no device has taken
    std::map<std::size_t, Task> looked_at_;  ///< by device
    std::size_t delivered_ = 0;
    std::exception_ptr failure_;            ///< of the evaluation of the frame behind evaluated_
    bool stopped_ = false, ended_ = false;  ///< ended_: nothing more will be evaluated
    std::thread thread_;
};

}  // namespace kadr
