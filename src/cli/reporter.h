#pragma once

#include <memory>

#include "base/error.h"
#include "render/render_job.h"

namespace kadr {

/// Tells the user how a render goes.
class Reporter {
public:
    virtual ~Reporter() = default;
    virtual void warning(const Diagnostic& warning) = 0;
    virtual void progress(int frame, double fraction, int frames_left) = 0;  ///< from any thread
    virtual void compiling(double seconds) = 0;  ///< from any thread
    virtual void shot_started(const ShotStart& shot) = 0;                        ///< of a reel
    virtual void frame_done(const FrameReport& report) = 0;
    virtual void summary(const RenderSummary& summary) = 0;
    /// Before anything else is printed: takes a progress bar away.
    virtual void clear() {}
    RenderEvents events();
};

/// JSON lines, a progress bar (standard error is a terminal) or one plain line a frame.
std::unique_ptr<Reporter> make_reporter(bool json, bool stats);

}  // namespace kadr
