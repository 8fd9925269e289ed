#include "device/tables/bounds_tree.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace kadr {
namespace {

using kernels::Vec3f;
using kernels::Vertex;

constexpr std::size_t kGroup = 8;

struct Box {
    Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
    void add(Vec3f p) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
    void add(const Box& box) {
        add(box.low);
        add(box.high);
    }
    double area() const {
        const double x = high.x - low.x, y = high.y - low.y, z = high.z - low.z;
        return x * y + y * z + z * x;
    }
};

/// Spreads ten bits so that two others fit between each two.
std::uint32_t spread(std::uint32_t x) {
    x = (x | x << 16) & 0x030000FFu;
    x = (x | x << 8) & 0x0300F00Fu;
    x = (x | x << 4) & 0x030C30C3u;
    return (x | x << 2) & 0x09249249u;
}

std::uint32_t cell(float at, float low, float high) {
    const float size = high - low;
    return size > 0 ? static_cast<std::uint32_t>(std::clamp((at - low) / size * 1023.0f, 0.0f, 1023.0f)) : 0u;
}

Box box_of(std::span<const Vertex> vertices, const std::uint32_t* triangle) {
    Box box;
    for (int corner = 0; corner < 3; ++corner) box.add(vertices[triangle[corner]].position);
    return box;
}

std::vector<Box> grouped(std::size_t count, const auto& box_at) {
    std::vector<Box> groups((count + kGroup - 1) / kGroup);
    tbb::parallel_for(std::size_t{0}, groups.size(), [&](std::size_t g) {
        for (std::size_t i = g * kGroup; i < std::min((g + 1) * kGroup, count); ++i) groups[g].add(box_at(i));
    });
    return groups;
}

}  // namespace

void BoundsTree::order(std::span<const Vertex> vertices, const std::vector<std::uint32_t>& indices) {
    Box whole;
    for (const Vertex& vertex : vertices) whole.add(vertex.position);
    std::vector<std::uint32_t> codes(indices.size() / 3);
    tbb::parallel_for(std::size_t{0}, codes.size(), [&](std::size_t t) {
        const Box box = box_of(vertices, &indices[3 * t]);
        const Vec3f c = (box.low + box.high) * 0.5f;
        codes[t] = spread(cell(c.x, whole.low.x, whole.high.x)) | spread(cell(c.y, whole.low.y, whole.high.y)) << 1 | spread(cell(c.z, whole.low.z, whole.high.z)) << 2;
    });
    order_.resize(codes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    tbb::parallel_sort(order_.begin(), order_.end(), [&](std::uint32_t a, std::uint32_t b) { return codes[a] != codes[b] ? codes[a] < codes[b] : a < b; });
}

double BoundsTree::cost(std::span<const Vertex> vertices, const std::vector<std::uint32_t>& indices) const {
    std::vector<Box> level = grouped(order_.size(), [&](std::size_t i) { return box_of(vertices, &indices[3 * static_cast<std::size_t>(order_[i])]); });
    double areas = 0;
    for (;;) {
        for (const Box& box : level) areas += box.area();
        if (level.size() <= 1) break;
        level = grouped(level.size(), [&](std::size_t i) { return level[i]; });
    }
    const double root = level.empty() ? 0 : level.front().area();
    return root > 0 ? areas / root : 1;
}

}  // namespace kadr
