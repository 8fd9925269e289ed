#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "device/device.h"
#include "film/film.h"
#include "frame/frame_state.h"
#include "frame/motion_report.h"
#include "render/sample_steering.h"
#include "render/shot_budget.h"

namespace kadr {

/// One frame as it comes from the device: linear radiance and layers.
struct RenderedFrame {
    Image image;
    std::string device;            ///< that rendered it
    DeviceStatistics statistics;   ///< summed over the parts of the shutter
    MotionReport motion;
    SamplingReport sampling;
    double light_error = 0;        ///< SceneSnapshot::light_error, the largest of the parts
    double time_s = 0;             ///< of the shot
    double seconds = 0;
};

/// What decides how a frame is rendered beside its shot.
struct FrameRequest {
    FilmLayers layers;
    std::optional<ViewSpec> view;                            ///< with its exposure; absent: the shot's as it is written
    std::function<void(double fraction)> progress;
    std::optional<FrameTarget> target;                       ///< of a budget for the whole shot
    /// What will be rendered after this frame; null while nobody knows. Asked while the device is busy.
    std::function<std::shared_ptr<const SceneSnapshot>()> next;
};

/// The layers that a shot asks for.
FilmLayers film_layers(const std::vector<Aov>& aovs);

/// Adds the counters of one part of the work to those of the whole.
void add(DeviceStatistics& sum, const DeviceStatistics& part);

/// Renders frames of bound shots on one device, one after another; keeps a film of moderate size between frames.
class FrameRenderer {
public:
    /// @param clock  seconds since some moment, for time budgets; absent: the system's steady clock
    explicit FrameRenderer(Device& device, std::function<double()> clock = {});

    /// @throws Interrupted  when a signal asked to stop before the frame was complete
    RenderedFrame render(const BoundShot& shot, const FrameTime& time, const FrameRequest& request);
    /// The same of a frame that is evaluated already. @param parts  make_snapshots of the frame
    RenderedFrame render(const BoundShot& shot, const std::shared_ptr<const std::vector<SceneSnapshot>>& parts, const FrameRequest& request);

    /// Renders a few pixels of a frame, strewn over all of it, to see how difficult it is.
    ///
    /// @param layers     of the frames that come after it; the film is theirs
    /// @param most_s     wall time of the whole frame for which forecasts should hold
    /// @param statistics what that took is added to it
    FrameForecast pilot(const BoundShot& shot, const std::shared_ptr<const std::vector<SceneSnapshot>>& parts, const FilmLayers& layers, double most_s,
                        DeviceStatistics& statistics);

private:
    class Rounds;
    Film& cleared_film(const Shot& shot, const FilmLayers& layers, int halves, bool weighted);
    Image developed();

    Device* device_;
    std::function<double()> clock_;
    std::optional<Film> film_;
};

/// Renders the shot's first frame small and coarse. @return exposure in stops for `view.exposure: auto`
double meter_exposure(const Shot& shot, const Scene& scene, FrameRenderer& renderer, const FrameTime& first);

}  // namespace kadr
