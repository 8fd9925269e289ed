#pragma once

#include "render/render_job.h"

namespace kadr {

/// Renders the frames of every shot of a reel that are missing, then mixes and encodes the reel. A run that finds every
/// frame complete only does the latter.
/// @throws InputError, RenderError, Interrupted
RenderSummary render_reel(const RenderOptions& options, const RenderEvents& events);

/// Refuses to preview a reel, and says which frame of which shot to preview instead.
[[noreturn]] void refuse_reel_preview(const PreviewOptions& options);

}  // namespace kadr
