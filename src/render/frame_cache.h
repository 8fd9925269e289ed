#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <optional>

#include "base/hash.h"
#include "render/frame_renderer.h"

namespace kadr {

/// Eight frames of 1920 x 1080 without layers. A frame that holds needs one, a short loop as many as it has.
inline constexpr std::size_t kMostCachedBytes = std::size_t{256} << 20;

/// Frames that may come again, of a shot that holds, loops or swings to and fro. The least recently used ones make room;
/// the newest is always kept.
class FrameCache {
public:
    explicit FrameCache(std::size_t most_bytes) : most_bytes_(most_bytes) {}

    struct Found {
        int number;  ///< of the frame that was rendered
        std::shared_ptr<const RenderedFrame> frame;
    };
    std::optional<Found> find(const Hash& key);
    void keep(const Hash& key, int number, std::shared_ptr<const RenderedFrame> frame);

private:
    struct Entry {
        Hash key;
        Found found;
    };
    std::size_t most_bytes_, bytes_ = 0;
    std::list<Entry> entries_;  ///< most recently used first; few, so that looking through them costs nothing
};

}  // namespace kadr
