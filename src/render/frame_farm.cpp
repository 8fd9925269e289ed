#include "render/frame_farm.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "render/environment_image.h"
#include "render/kernel_set.h"
#include "render/render_job.h"
#include "render/shot_pilot.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

ViewSpec with_exposure(ViewSpec view, double stops) {
    view.exposure_stops = stops;
    view.automatic = false;
    return view;
}

}  // namespace

FrameFarm::FrameFarm(const LoadedShot& shot, std::vector<DeviceChoice> devices, Settings settings)
    : shot_(shot),
      settings_(std::move(settings)),
      budget_(shot.shot().render.time_budget_shot_s, settings_.clock, devices.size()) {
    for (DeviceChoice& device : devices) {
        device.device->watch({settings_.compiling, &interrupt_requested()});
        workers_.push_back(std::make_unique<Worker>(workers_.size(), std::move(device)));
    }
}

FrameFarm::~FrameFarm() {
    if (schedule_) schedule_->stop(std::make_exception_ptr(Interrupted()));
    join();
}

DeviceStatistics FrameFarm::plan_budget(const std::vector<int>& frames, const std::function<std::optional<double>(const FrameTime&)>& there) {
    Worker& worker = *workers_.front();
    load(worker);
    DeviceStatistics taken;
    budget_.plan(pilot_frames({shot_.bound(), frames, there, film_layers(shot_.shot().output.aovs), budget_.remaining_s(),
                               settings_.clock, workers_.size()},
                              worker.renderer, taken));
    return taken;
}

void FrameFarm::start(FrameSchedule& schedule) {
    schedule_ = &schedule;
    prepare();
    for (const auto& worker : workers_) worker->thread = std::thread([this, &one = *worker] { work(one); });
}

/// What a shot needs takes a while to find out, and kernels up to a minute: both go on while the scene is copied to the
/// devices and the first frames are evaluated.
void FrameFarm::prepare() {
    if (std::none_of(workers_.begin(), workers_.end(), [](const auto& worker) { return worker->choice.device->compiles(); })) return;
    prepared_ = std::async(std::launch::async, [this] {
        const KernelSet set = kernel_set_of(shot_.bound());
        for (const auto& worker : workers_) worker->choice.device->prepare(set);
    });
}

void FrameFarm::join() noexcept {
    for (const auto& worker : workers_)
        if (worker->thread.joinable()) worker->thread.join();
}

std::string FrameFarm::names() const {
    std::string names;
    for (const auto& worker : workers_) names += (names.empty() ? "" : " and ") + worker->choice.device->name();
    return names;
}

std::string FrameFarm::why() const { return workers_.front()->choice.why; }

double FrameFarm::load_s() const {
    double sum = 0;
    for (const auto& worker : workers_) sum += worker->load_s;
    return sum;
}

void FrameFarm::work(Worker& worker) {
    while (const FrameSchedule::Task task = schedule_->take(worker.number)) {
        try {
            const auto frame = std::make_shared<const RenderedFrame>(render(worker, *task));
            task->parts.reset();
            settings_.rendered(*task, frame);
            task->promise.set_value(frame);
        } catch (...) {
            const std::exception_ptr error = named(worker, std::current_exception());
            task->promise.set_exception(error);
            schedule_->stop(error);
        }
        const std::lock_guard lock(mutex_);
        under_way_.erase(task->index);
    }
}

/// What went wrong on one of several devices says on which.
std::exception_ptr FrameFarm::named(const Worker& worker, std::exception_ptr error) const {
    if (workers_.size() == 1) return error;
    try {
        std::rethrow_exception(error);
    } catch (const RenderError& failure) {
        return std::make_exception_ptr(
            RenderError(fmt::format("{}: {}", worker.choice.device->name(), failure.what())));
    } catch (...) {
        return error;
    }
}

RenderedFrame FrameFarm::render(Worker& worker, const FrameTask& task) {
    const std::lock_guard busy(worker.busy);
    load(worker);
    {
        const std::lock_guard lock(mutex_);
        under_way_.insert(task.index);
    }
    FrameRequest request;
    request.layers = film_layers(shot_.shot().output.aovs);
    request.view = view_of(task.time, worker);
    request.progress = [&](double fraction) { report(task, fraction); };
    request.target = budget_.begin(task.time.number, worker.number);
    request.next = [&] { return schedule_->look_ahead(worker.number); };
    RenderedFrame frame = worker.renderer.render(shot_.bound(), task.parts, request);
    budget_.end(frame.sampling.error.relmse, worker.number);
    return frame;
}

/// On the first frame that a device has to render: a run that finds every frame complete builds nothing.
void FrameFarm::load(Worker& worker) {
    if (worker.loaded) return;
    const Stopwatch watch;
    load_device(*worker.choice.device, shot_);
    worker.load_s = watch.seconds();
    worker.loaded = true;
    // A frame that came first would have a kernel of its own compiled.
    std::call_once(waited_, [this] {
        if (prepared_.valid()) prepared_.get();
    });
}

ViewSpec FrameFarm::view_of(const FrameTime& time) {
    ViewSpec view = view_at(shot_.shot().view, time.time_s());
    if (!view.automatic) return view;
    {
        const std::lock_guard metering(metering_);
        if (exposure_) return with_exposure(view, *exposure_);
    }
    const std::lock_guard busy(workers_.front()->busy);
    return view_of(time, *workers_.front());
}

/// @pre the worker is held: before the metering, so that nobody waits for both in the other order
ViewSpec FrameFarm::view_of(const FrameTime& time, Worker& worker) {
    const ViewSpec view = view_at(shot_.shot().view, time.time_s());
    if (!view.automatic) return view;
    const std::lock_guard metering(metering_);
    if (!exposure_) {
        load(worker);
        exposure_ = meter_exposure(shot_.shot(), shot_.scene(), worker.renderer,
                                   shot_.bound().sequence().frame(settings_.metered_frame));
    }
    return with_exposure(view, *exposure_);
}

/// Of several frames under way, the earliest one's.
void FrameFarm::report(const FrameTask& task, double fraction) {
    {
        const std::lock_guard lock(mutex_);
        if (under_way_.empty() || *under_way_.begin() != task.index) return;
    }
    settings_.progress(task.time.number, fraction, static_cast<int>(settings_.frames - task.index) - 1);
}

}  // namespace kadr
