#pragma once

#include <optional>
#include <vector>

#include "frame/frame_state.h"
#include "device/device.h"
#include "frame/shot_needs.h"
#include "frame/slipping.h"
#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// What is read of a shot's files: what it needs, or all that they hold, for who wants to know whether it can be read.
enum class Reading { needed, everything };

/// A shot with its scenes and the names bound between them. Stays where it is: the bound shot points into it.
class LoadedShot {
public:
    /// @throws InputError  from the loader or from binding
    explicit LoadedShot(Shot shot, const LoadOptions& options = {}, Reading reading = Reading::needed);
    LoadedShot(const LoadedShot&) = delete;
    LoadedShot& operator=(const LoadedShot&) = delete;

    const Shot& shot() const { return shot_; }
    const Scene& scene() const { return scene_; }
    const BoundShot& bound() const { return bound_; }
    /// What of the files was not read, and why.
    const std::vector<Unread>& left_out() const { return left_out_; }
    /// Those of the shot, the scenes, the binding and the numbers' precision, in this order.
    std::vector<Diagnostic> warnings() const;

    /// Where too many rays would slip between triangles; looked for only where the shot leaves `render.robust` to us.
    std::optional<Slipping> slipping() const;
    BuildSettings build_settings() const;

private:
    Shot shot_;
    std::vector<Unread> left_out_;
    Scene scene_;
    BoundShot bound_;
};

/// The glTF files that a shot names, and the clips that it plays.
std::vector<SceneFileRequest> scene_requests(const Shot& shot);

/// The size with the longer side at most `max_width`, the aspect kept, at least one pixel high.
ImageSpec limited_width(ImageSpec image, int max_width);

}  // namespace kadr
