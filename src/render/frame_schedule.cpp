#include "render/frame_schedule.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "render/render_job.h"

namespace kadr {
namespace {

/// Frames that are complete on disk, or repeat others, are cheap, but there may be a million of them.
constexpr std::size_t kMostEvaluated = 64;
constexpr std::chrono::milliseconds kLookForInterrupts{20};

/// How many frames a device may be beyond the one that is delivered next: with several devices a slow frame must not
/// hold up the others, and finished pictures must not pile up.
std::size_t most_ahead(std::size_t devices) { return devices == 1 ? 2 : 4 * devices; }

}  // namespace

FrameSchedule::FrameSchedule(std::size_t frames, std::size_t devices, std::function<Task(std::size_t)> evaluate)
    : devices_(devices), most_ahead_(most_ahead(devices)), evaluate_(std::move(evaluate)) {
    thread_ = std::thread([this, frames] { evaluate_all(frames); });
}

FrameSchedule::~FrameSchedule() {
    stop(std::make_exception_ptr(Interrupted()));
    thread_.join();
}

void FrameSchedule::stop(const std::exception_ptr& why) {
    const std::lock_guard lock(mutex_);
    stopped_ = true;
    for (const Task& task : waiting_) task->promise.set_exception(why);
    waiting_.clear();
    changed_.notify_all();
}

void FrameSchedule::evaluate_all(std::size_t frames) {
    std::exception_ptr failure;
    for (std::size_t index = 0; index < frames && !failure; ++index) {
        {
            std::unique_lock lock(mutex_);
            changed_.wait(
                lock, [&] { return stopped_ || (waiting_.size() < devices_ && index < delivered_ + kMostEvaluated); });
            if (stopped_ || interrupt_requested()) break;
        }
        Task task;
        try {
            task = evaluate_(index);
        } catch (...) {
            failure = std::current_exception();
        }
        const std::lock_guard lock(mutex_);
        if (task) evaluated_.push_back(task);
        if (task && task->is_to_be_rendered()) waiting_.push_back(task);
        changed_.notify_all();
    }
    const std::lock_guard lock(mutex_);
    failure_ = failure;
    ended_ = true;
    changed_.notify_all();
}

bool FrameSchedule::has_its_eye_on(std::size_t device, const Task& task) const {
    const auto looked = looked_at_.find(device);
    return looked != looked_at_.end() && looked->second == task;
}

bool FrameSchedule::is_free(const Task& task) const {
    return std::none_of(looked_at_.begin(), looked_at_.end(),
                        [&](const auto& looked) { return looked.second == task; });
}

std::deque<FrameSchedule::Task>::iterator FrameSchedule::choose(std::size_t device) {
    const auto own = std::find_if(waiting_.begin(), waiting_.end(),
                                  [&](const Task& task) { return is_wanted(task) && has_its_eye_on(device, task); });
    if (own != waiting_.end()) return own;
    const auto free = std::find_if(waiting_.begin(), waiting_.end(),
                                   [&](const Task& task) { return is_wanted(task) && is_free(task); });
    if (free != waiting_.end()) return free;
    return std::find_if(waiting_.begin(), waiting_.end(), [&](const Task& task) { return is_wanted(task); });
}

FrameSchedule::Task FrameSchedule::take(std::size_t device) {
    std::unique_lock lock(mutex_);
    auto at = waiting_.end();
    changed_.wait(lock,
                  [&] { return stopped_ || (at = choose(device)) != waiting_.end() || (ended_ && waiting_.empty()); });
    if (stopped_ || at == waiting_.end()) return nullptr;
    Task task = *at;
    waiting_.erase(at);
    std::erase_if(looked_at_, [&](const auto& looked) { return looked.second == task; });
    changed_.notify_all();
    return task;
}

std::shared_ptr<const SceneSnapshot> FrameSchedule::look_ahead(std::size_t device) {
    const std::lock_guard lock(mutex_);
    if (stopped_) return nullptr;
    Task& task = looked_at_[device];
    if (!task)
        for (const Task& one : waiting_)
            if (is_free(one)) {
                task = one;
                break;
            }
    return task ? std::shared_ptr<const SceneSnapshot>(task->parts, &task->parts->front()) : nullptr;
}

FrameSchedule::Task FrameSchedule::at(std::size_t index) {
    std::unique_lock lock(mutex_);
    while (true) {
        if (index - delivered_ < evaluated_.size()) return evaluated_[index - delivered_];
        if (interrupt_requested() || (ended_ && !failure_)) throw Interrupted();
        if (failure_) std::rethrow_exception(failure_);
        changed_.wait_for(lock, kLookForInterrupts);
    }
}

void FrameSchedule::delivered() {
    const std::lock_guard lock(mutex_);
    evaluated_.pop_front();
    ++delivered_;
    changed_.notify_all();
}

std::deque<FrameSchedule::Task> FrameSchedule::left() const {
    const std::lock_guard lock(mutex_);
    return evaluated_;
}

}  // namespace kadr
