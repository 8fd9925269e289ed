#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/glm.hpp>

namespace kadr {

struct ExactBox {
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    void add(const glm::dvec3& p) { low = glm::min(low, p), high = glm::max(high, p); }
    void add(const ExactBox& box) { add(box.low), add(box.high); }
};

/// A ray in the coordinates of the boxes; its distances are in units of `direction`, of any length.
struct ExactRay {
    glm::dvec3 origin, direction;
};

/// Boxes in a binary tree: what a ray may meet, without looking at everything. For the reference: simple, in double, and
/// never too narrow.
class BoxTree {
public:
    BoxTree() = default;
    explicit BoxTree(const std::vector<ExactBox>& boxes);

    /// Calls meet(box) for every box that the ray may touch before `farthest`, which meet may reduce, until meet returns
    /// true. @return whether it did
    template <class Meet>
    bool visit(const ExactRay& ray, const double& farthest, const Meet& meet) const {
        if (nodes_.empty()) return false;
        const glm::dvec3 inverse = 1.0 / ray.direction;
        std::uint32_t stack[64] = {0};
        for (int size = 1; size > 0;) {
            const std::uint32_t at = stack[--size];
            const Node& node = nodes_[at];
            if (!touches(node.box, ray.origin, inverse, farthest)) continue;
            if (node.count > 0) {
                for (std::uint32_t i = 0; i < node.count; ++i)
                    if (meet(order_[node.first + i])) return true;
            } else {
                stack[size++] = at + 1;
                stack[size++] = node.first;
            }
        }
        return false;
    }

private:
    /// A leaf holds order_[first, first + count); an inner node (count 0) is followed by its left child, its right one is
    /// nodes_[first].
    struct Node {
        ExactBox box;
        std::uint32_t first = 0, count = 0;
    };
    std::uint32_t build(const std::vector<ExactBox>& boxes, std::uint32_t first, std::uint32_t count);

    /// fmin and fmax pass over the 0 * infinity of a ray that runs along a face.
    static bool touches(const ExactBox& box, const glm::dvec3& origin, const glm::dvec3& inverse, double farthest) {
        double enter = 0, leave = farthest;
        for (int axis = 0; axis < 3; ++axis) {
            const double a = (box.low[axis] - origin[axis]) * inverse[axis], b = (box.high[axis] - origin[axis]) * inverse[axis];
            enter = std::fmax(enter, std::fmin(a, b));
            leave = std::fmin(leave, std::fmax(a, b));
        }
        constexpr double kRounding = 1e-12;  // of distances: three operations with 2^-53 each, and room
        return enter <= leave * (1 + kRounding) + kRounding * std::abs(enter);
    }

    std::vector<Node> nodes_;
    std::vector<std::uint32_t> order_;
};

}  // namespace kadr
