#include "device/exact/box_tree.h"

#include <numeric>

namespace kadr {

BoxTree::BoxTree(const std::vector<ExactBox>& boxes) {
    if (boxes.empty()) return;
    order_.resize(boxes.size());
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.reserve(boxes.size());
    build(boxes, 0, static_cast<std::uint32_t>(boxes.size()));
}

/// Halves by the middle box along the longest side of the boxes' centres: never deeper than the logarithm of their number.
std::uint32_t BoxTree::build(const std::vector<ExactBox>& boxes, std::uint32_t first, std::uint32_t count) {
    constexpr std::uint32_t kLeaf = 4;
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    nodes_.emplace_back();
    ExactBox box, centres;
    const auto centre = [&](std::uint32_t i) { return 0.5 * (boxes[i].low + boxes[i].high); };
    for (std::uint32_t i = first; i < first + count; ++i) box.add(boxes[order_[i]]), centres.add(centre(order_[i]));
    nodes_[at].box = box;
    if (count <= kLeaf) {
        nodes_[at].first = first, nodes_[at].count = count;
        return at;
    }
    const glm::dvec3 size = centres.high - centres.low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const std::uint32_t half = count / 2;
    std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count,
                     [&](std::uint32_t a, std::uint32_t b) { return centre(a)[axis] < centre(b)[axis]; });
    build(boxes, first, half);
    const std::uint32_t right = build(boxes, first + half, count - half);
    nodes_[at].first = right;
    return at;
}

}  // namespace kadr
