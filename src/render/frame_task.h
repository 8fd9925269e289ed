#pragma once

#include <cstddef>
#include <exception>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <vector>

#include "base/hash.h"
#include "frame/snapshot.h"
#include "render/frame_identity.h"
#include "render/frame_renderer.h"

namespace kadr {

/// One frame of a render on its way from its evaluation to its files.
struct FrameTask {
    using Rendered = std::shared_ptr<const RenderedFrame>;

    std::size_t index = 0;  ///< among the frames of the render
    FrameTime time;
    std::vector<std::filesystem::path> files;
    FrameIdentity identity;
    bool reused = false;         ///< complete on disk: nothing is rendered
    std::optional<int> same_as;  ///< number of the frame whose pixels these are; nothing is rendered
    Hash key;                    ///< of all that its samples depend on
    std::shared_ptr<const std::vector<SceneSnapshot>> parts;  ///< what is to be rendered; null: nothing, or it is done
    std::promise<Rendered> promise;
    std::shared_future<Rendered> rendered = promise.get_future().share();  ///< not of one that is reused

    bool is_to_be_rendered() const { return parts != nullptr; }
};

}  // namespace kadr
