#include "render/frame_cache.h"

#include <algorithm>

namespace kadr {
namespace {

std::size_t bytes_of(const RenderedFrame& frame) { return frame.image.pixels.size() * sizeof(float); }

}  // namespace

std::optional<FrameCache::Found> FrameCache::find(const Hash& key) {
    const auto at = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& entry) { return entry.key == key; });
    if (at == entries_.end()) return std::nullopt;
    entries_.splice(entries_.begin(), entries_, at);
    return entries_.front().found;
}

void FrameCache::keep(const Hash& key, int number, std::shared_ptr<const RenderedFrame> frame) {
    bytes_ += bytes_of(*frame);
    entries_.push_front({key, {number, std::move(frame)}});
    while (entries_.size() > 1 && bytes_ > most_bytes_) {
        bytes_ -= bytes_of(*entries_.back().found.frame);
        entries_.pop_back();
    }
}

}  // namespace kadr
