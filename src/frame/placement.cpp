#include "frame/placement.h"

#include <cmath>

namespace kadr {

namespace {

/// Which random number of a copy is which.
enum Dimension : std::uint32_t { kYaw, kScale, kOffset, kJitter /* three */ };

Placement placement_of(const PlacementSpec& spec) {
    return {spec.translate_m, glm::quat(spec.rotate), glm::vec3(spec.scale), static_cast<float>(spec.offset_s)};
}

glm::dvec3 jittered(const InstancesSpec& spec, const GridSpec& grid, std::uint32_t number) {
    glm::dvec3 offset;
    for (int i = 0; i < 3; ++i)
        offset[i] = grid.spacing_m[i] * grid.jitter * (2 * random_unit(spec.seed, number, kJitter + static_cast<std::uint32_t>(i)) - 1);
    return offset;
}

std::vector<Placement> place_grid(const InstancesSpec& spec, const GridSpec& grid) {
    const auto [nx, ny, nz] = grid.counts;
    const glm::dvec3 middle = 0.5 * glm::dvec3(nx - 1, ny - 1, nz - 1);
    std::vector<Placement> placements;
    placements.reserve(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz));
    for (int z = 0; z < nz; ++z)
        for (int y = 0; y < ny; ++y)
            for (int x = 0; x < nx; ++x) {
                const auto number = static_cast<std::uint32_t>(placements.size());
                Placement& placement = placements.emplace_back();
                placement.translation = (glm::dvec3(x, y, z) - middle) * grid.spacing_m + jittered(spec, grid, number);
                vary(spec, number, placement);
            }
    return placements;
}

}  // namespace

/// Source: the finaliser of MurmurHash3 (Appleby 2011), chained over the arguments.
double random_unit(std::uint32_t seed, std::uint32_t number, std::uint32_t dimension) {
    const auto mix = [](std::uint64_t h) {
        h = (h ^ (h >> 33)) * 0xff51afd7ed558ccdULL;
        h = (h ^ (h >> 33)) * 0xc4ceb9fe1a85ec53ULL;
        return h ^ (h >> 33);
    };
    const std::uint64_t h = mix(mix(mix(seed + 1ULL) + number + 1ULL) + dimension + 1ULL);
    return static_cast<double>(h >> 11) * 0x1p-53;
}

void vary(const InstancesSpec& spec, std::uint32_t number, Placement& placement) {
    const auto within = [&](const glm::dvec2& range, Dimension dimension) {
        return range.x + (range.y - range.x) * random_unit(spec.seed, number, dimension);
    };
    const double yaw = spec.random_yaw_rad * (random_unit(spec.seed, number, kYaw) - 0.5);
    placement.rotation = placement.rotation * glm::quat(glm::angleAxis(yaw, glm::dvec3(0, 1, 0)));
    placement.scale *= static_cast<float>(within(spec.random_scale, kScale));
    double share = random_unit(spec.seed, number, kOffset);
    if (spec.offset_steps > 0) share = std::floor(share * spec.offset_steps) / spec.offset_steps;
    placement.clip_offset_s += static_cast<float>(std::lerp(spec.random_offset_s.x, spec.random_offset_s.y, share));
}

std::vector<Placement> place_copies(const InstancesSpec& spec) {
    if (spec.grid) return place_grid(spec, *spec.grid);
    std::vector<Placement> placements;
    for (const PlacementSpec& place : spec.list) placements.push_back(placement_of(place));
    return placements;
}

}  // namespace kadr
