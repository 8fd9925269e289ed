#include "device/tables/subdivide.h"

#include <algorithm>
#include <array>
#include <unordered_map>

namespace kadr {
namespace {

constexpr double kLongest = 256;  ///< of its distance
constexpr double kNear = 16;      ///< distances below are as good as this: the camera itself lies up to 64 away

/// @return the squared length of an edge against what is allowed, at most 1 where it may stay
double excess(const glm::dvec3& a, const glm::dvec3& b) {
    const glm::dvec3 along = b - a;
    const double length2 = glm::dot(along, along);
    const double t = length2 > 0 ? std::clamp(-glm::dot(a, along) / length2, 0.0, 1.0) : 0;
    const glm::dvec3 nearest = a + along * t;
    return length2 / (kLongest * kLongest * std::max(glm::dot(nearest, nearest), kNear * kNear));
}

class Subdivider {
public:
    Subdivider(std::vector<glm::dvec3>& positions, std::vector<std::uint32_t> indices) : positions_(positions) { result_.indices = std::move(indices); }

    Subdivision run() {
        // Each round halves all edges that are too long: 64 reach from the largest floats to the smallest edge.
        for (int round = 0; round < 64 && halve(); ++round) {}
        return std::move(result_);
    }

private:
    bool too_long(std::uint32_t a, std::uint32_t b) const { return excess(positions_[a], positions_[b]) > 1; }

    std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [entry, is_new] = middles_.try_emplace(edge, static_cast<std::uint32_t>(positions_.size()));
        if (is_new) {
            // In one order, whichever triangle asks: the same sum, rounded alike, for vertices that lie in the same place.
            positions_.push_back(0.5 * positions_[a] + 0.5 * positions_[b]);
            result_.added.push_back({a, b});
        }
        return entry->second;
    }

    bool halve() {
        std::vector<std::uint32_t> next;
        middles_.clear();
        for (std::size_t t = 0; t + 2 < result_.indices.size(); t += 3) split({result_.indices[t], result_.indices[t + 1], result_.indices[t + 2]}, next);
        result_.indices = std::move(next);
        return !middles_.empty();
    }

    /// Into one to four triangles of the same winding.
    void split(std::array<std::uint32_t, 3> t, std::vector<std::uint32_t>& out) {
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.insert(out.end(), {a, b, c}); };
        std::array<bool, 3> cut{};  // edge i runs from corner i to the next
        for (std::size_t i = 0; i < 3; ++i) cut[i] = too_long(t[i], t[(i + 1) % 3]);
        const long cuts = std::count(cut.begin(), cut.end(), true);
        if (cuts == 0) return add(t[0], t[1], t[2]);
        // Turned so that the first edge is cut, and of two the last one is not.
        while (!cut[0] || (cuts == 2 && cut[2])) std::rotate(t.begin(), t.begin() + 1, t.end()), std::rotate(cut.begin(), cut.begin() + 1, cut.end());
        const std::uint32_t m0 = middle(t[0], t[1]);
        if (cuts == 1) return add(t[0], m0, t[2]), add(m0, t[1], t[2]);
        const std::uint32_t m1 = middle(t[1], t[2]);
        if (cuts == 2) return add(m0, t[1], m1), add(t[0], m0, m1), add(t[0], m1, t[2]);
        const std::uint32_t m2 = middle(t[2], t[0]);
        add(t[0], m0, m2), add(m0, t[1], m1), add(m2, m1, t[2]), add(m0, m1, m2);
    }

    std::vector<glm::dvec3>& positions_;
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< of this round
    Subdivision result_;
};

}  // namespace

Subdivision subdivide_near_origin(std::vector<glm::dvec3>& positions, const std::vector<std::uint32_t>& indices) {
    const auto long_edge = [&](std::size_t i) { return excess(positions[indices[i]], positions[indices[i % 3 == 2 ? i - 2 : i + 1]]) > 1; };
    for (std::size_t i = 0; i < indices.size(); ++i)
        if (long_edge(i)) return Subdivider(positions, indices).run();
    return {};
}

}  // namespace kadr
