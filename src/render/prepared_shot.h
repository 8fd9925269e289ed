#pragma once

#include <optional>

#include "render/render_job.h"
#include "shot/shot.h"

namespace kadr {

/// A shot that was parsed, and maybe changed, by who wants it rendered.
struct PreparedShot {
    Shot shot;
    std::optional<int> metered_frame;  ///< whose brightness an automatic exposure holds; none: the first of the shot
    bool view_wanted = false;          ///< RenderSummary::view is needed, even where every frame is reused
};

/// As render_shot; of the options only the device and `overwrite` are looked at.
/// @throws InputError, RenderError, Interrupted
RenderSummary render_prepared(PreparedShot shot, const RenderOptions& options, const RenderEvents& events);

}  // namespace kadr
