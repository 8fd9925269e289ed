#include "frame/instance_list.h"

#include <algorithm>

namespace kadr {

namespace {

int file_of(const Scene& scene, int node) {
    const auto after = std::upper_bound(scene.files.begin(), scene.files.end(), node, [](int n, const SceneFile& file) { return n < file.first_node; });
    return static_cast<int>(after - scene.files.begin()) - 1;
}

}  // namespace

InstanceList::InstanceList(std::span<const InstanceSeed> seeds, const Scene& scene, std::vector<std::vector<Placement>> copies)
    : copies_(std::move(copies)) {
    groups_.reserve(seeds.size());
    for (const InstanceSeed& seed : seeds) {
        const int set = scene.nodes[static_cast<std::size_t>(seed.mesh_node)].placement_set;
        Group group{&seed, copies_of(file_of(scene, seed.node)), {}, size_};
        if (set >= 0) group.locals = scene.placement_sets[static_cast<std::size_t>(set)];
        size_ += std::max<std::size_t>(group.copies.size(), 1) * std::max<std::size_t>(group.locals.size(), 1);
        groups_.push_back(group);
    }
}

Instance InstanceList::of_group(const Group& group, std::size_t id) const {
    const std::size_t number = id - group.first, locals = std::max<std::size_t>(group.locals.size(), 1);
    return {group.seed, group.copies.empty() ? nullptr : &group.copies[number / locals], group.locals.empty() ? nullptr : &group.locals[number % locals],
            static_cast<std::uint32_t>(id)};
}

Instance InstanceList::operator[](std::size_t id) const {
    const auto after = std::upper_bound(groups_.begin(), groups_.end(), id, [](std::size_t i, const Group& group) { return i < group.first; });
    return of_group(after[-1], id);
}

std::vector<Instance> InstanceList::range(std::size_t first, std::size_t count) const {
    std::vector<Instance> instances;
    instances.reserve(count);
    auto group = std::upper_bound(groups_.begin(), groups_.end(), first, [](std::size_t i, const Group& g) { return i < g.first; }) - 1;
    for (std::size_t id = first; id < first + count; ++id) {
        while (group + 1 != groups_.end() && group[1].first <= id) ++group;
        instances.push_back(of_group(*group, id));
    }
    return instances;
}

std::vector<IdRange> InstanceList::of_seeds(const std::function<bool(const InstanceSeed&)>& chosen) const {
    std::vector<IdRange> ranges;
    for (std::size_t g = 0; g < groups_.size(); ++g) {
        if (!chosen(*groups_[g].seed)) continue;
        const std::size_t first = groups_[g].first, end = g + 1 < groups_.size() ? groups_[g + 1].first : size_;
        if (!ranges.empty() && ranges.back().first + ranges.back().count == first)
            ranges.back().count += end - first;
        else
            ranges.push_back({first, end - first});
    }
    return ranges;
}

std::size_t InstanceList::bytes() const {
    std::size_t bytes = groups_.size() * sizeof(Group);
    for (const auto& placements : copies_) bytes += placements.capacity() * sizeof(Placement);
    return bytes;
}

}  // namespace kadr
