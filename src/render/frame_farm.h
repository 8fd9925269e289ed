#pragma once

#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "device/device.h"
#include "render/frame_renderer.h"
#include "render/frame_schedule.h"
#include "render/loaded_shot.h"
#include "render/shot_budget.h"

namespace kadr {

/// Devices that render the frames of a shot, each on a thread of its own: whoever is free takes the next one. With one
/// device it is the same, for one.
class FrameFarm {
public:
    struct Settings {
        int metered_frame = 0;          ///< whose brightness an automatic exposure holds
        std::size_t frames = 0;         ///< of the render
        std::function<double()> clock;  ///< seconds since the render began
        std::function<void(int frame, double fraction, int frames_left)> progress;  ///< of the earliest frame under way
        std::function<void(double seconds)> compiling;   ///< a frame waits for its kernels
        /// Called by a device's thread, before anybody else hears of the frame.
        std::function<void(const FrameTask&, const FrameTask::Rendered&)> rendered;
    };

    /// @param shot  outlives the farm
    FrameFarm(const LoadedShot& shot, std::vector<DeviceChoice> devices, Settings settings);
    /// Waits for the frames under way.
    ~FrameFarm();
    FrameFarm(const FrameFarm&) = delete;
    FrameFarm& operator=(const FrameFarm&) = delete;

    /// Of a shot with a time budget: looks ahead at what its frames take, on the first device. Before start().
    /// @param there  frames that are complete already  @return what that took
    DeviceStatistics plan_budget(const std::vector<int>& frames, const std::function<std::optional<double>(const FrameTime&)>& there);
    /// Begins to render. What fails is what the frame's future throws; with several devices it says which one failed.
    /// @param schedule  outlives the farm
    void start(FrameSchedule& schedule);
    /// Waits until all that the schedule handed out is rendered.
    void join() noexcept;
    /// The shot's view at a time; an automatic exposure is metered by the first who asks, once. Waits for a device
    /// then.
    ViewSpec view_of(const FrameTime& time);

    std::string names() const;  ///< of all devices
    std::string why() const;    ///< they were chosen
    std::size_t size() const { return workers_.size(); }
    bool has_robust_rays() const { return workers_.front()->choice.device->has_robust_rays(); }  ///< all devices are of a kind
    double load_s() const;  ///< that loading the scene took, summed over the devices

private:
    struct Worker {
        Worker(std::size_t number_of_it, DeviceChoice device)
            : number(number_of_it), choice(std::move(device)), renderer(*choice.device) {}
        const std::size_t number;
        DeviceChoice choice;
        FrameRenderer renderer;
        bool loaded = false;
        double load_s = 0;
        std::mutex busy;  ///< held by whoever uses the device
        std::thread thread;
    };
    void work(Worker& worker);
    RenderedFrame render(Worker& worker, const FrameTask& task);
    void prepare();
    void load(Worker& worker);
    ViewSpec view_of(const FrameTime& time, Worker& worker);
    void report(const FrameTask& task, double fraction);
    std::exception_ptr named(const Worker& worker, std::exception_ptr error) const;

    const LoadedShot& shot_;
    const Settings settings_;
    ShotBudget budget_;
    FrameSchedule* schedule_ = nullptr;
    std::vector<std::unique_ptr<Worker>> workers_;
    std::mutex metering_;
    std::optional<double> exposure_;
    std::mutex mutex_;
    std::set<std::size_t> under_way_;  ///< indices
    std::future<void> prepared_;        ///< kernels are being compiled; not valid: no device compiles any
    std::once_flag waited_;             ///< for that
};

}  // namespace kadr
