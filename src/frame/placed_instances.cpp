#include "frame/placed_instances.h"

#include <algorithm>
#include <string_view>
#include <type_traits>

#include "base/hash.h"

namespace kadr {

namespace {

/// A camera that moves back and forth over the border of two cells, or frames of two threads.
constexpr std::size_t kMostSpaces = 2;

template <class T>
void add_bytes(Hasher& hasher, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    hasher.add(std::string_view(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)));
}

}  // namespace

std::uint64_t key_of(const PlacedInstances& placed) {
    Hasher hasher;
    add_bytes(hasher, placed.instances);
    add_bytes(hasher, placed.fixed_places);
    add_bytes(hasher, placed.headers);
    add_bytes(hasher, placed.types);
    add_bytes(hasher, placed.linear);
    add_bytes(hasher, placed.srt);
    add_bytes(hasher, placed.matrices);
    return hasher.finish().low;
}

std::shared_ptr<const PlacedInstances> StillInstances::find(const RenderSpace& space) const {
    const std::lock_guard lock(mutex_);
    const auto found = std::find_if(latest_.begin(), latest_.end(), [&](const Entry& entry) { return entry.first == space; });
    return found == latest_.end() ? nullptr : found->second;
}

std::shared_ptr<const PlacedInstances> StillInstances::keep(const RenderSpace& space, std::shared_ptr<const PlacedInstances> placed) {
    const std::lock_guard lock(mutex_);
    for (const Entry& entry : latest_)
        if (entry.first == space) return entry.second;
    if (latest_.size() == kMostSpaces) latest_.erase(latest_.begin());
    latest_.emplace_back(space, std::move(placed));
    return latest_.back().second;
}

}  // namespace kadr
