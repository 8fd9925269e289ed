#include "device/tables/subdivide.h"

#include <algorithm>
#include <array>
#include <bit>
#include <unordered_map>
#include <unordered_set>

namespace kadr {
namespace {

constexpr double kLongest = 256;  ///< of the triangle's distance
constexpr double kNear = 16;      ///< distances below are as good as this: the camera itself lies up to 64 away

/// Distance of a triangle from the origin; where the origin lies above its inside, from its plane.
/// Source: Ericson, "Real-Time Collision Detection", 2005, 5.1.5, for a point at the origin.
double distance_to(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    const auto to_edge = [](const glm::dvec3& from, const glm::dvec3& to) {
        const glm::dvec3 along = to - from;
        const double length2 = glm::dot(along, along);
        const double t = length2 > 0 ? std::clamp(-glm::dot(from, along) / length2, 0.0, 1.0) : 0;
        return glm::length(from + along * t);
    };
    const glm::dvec3 normal = glm::cross(b - a, c - a);
    const auto inside_of = [&](const glm::dvec3& from, const glm::dvec3& to) { return glm::dot(glm::cross(to - from, -from), normal) >= 0; };
    const double edges = std::min({to_edge(a, b), to_edge(b, c), to_edge(c, a)});
    const double size = glm::length(normal);
    if (!(size > 0) || !inside_of(a, b) || !inside_of(b, c) || !inside_of(c, a)) return edges;
    return std::min(edges, std::abs(glm::dot(a, normal)) / size);
}

struct HashPlace {
    std::size_t operator()(const glm::dvec3& p) const {
        std::size_t h = 0;
        for (int i = 0; i < 3; ++i) h = (h ^ std::bit_cast<std::uint64_t>(p[i] + 0.0)) * 0x9E3779B97F4A7C15ull;
        return h ^ h >> 29;
    }
};

class Subdivider {
public:
    Subdivider(std::vector<glm::dvec3>& positions, std::vector<std::uint32_t> indices) : positions_(positions) {
        result_.indices = std::move(indices);
        for (const glm::dvec3& p : positions) add_place(p);
    }

    Subdivision run() {
        // Each round halves all edges that are too long: 64 reach from the largest floats to the smallest edge.
        for (int round = 0; round < 64 && mark(); ++round) halve();
        return std::move(result_);
    }

private:
    using Triangle = std::array<std::uint32_t, 3>;

    Triangle triangle(std::size_t t) const { return {result_.indices[3 * t], result_.indices[3 * t + 1], result_.indices[3 * t + 2]}; }
    std::size_t triangle_count() const { return result_.indices.size() / 3; }

    void add_place(const glm::dvec3& p) { places_.push_back(place_ids_.try_emplace(p + 0.0, static_cast<std::uint32_t>(place_ids_.size())).first->second); }

    /// The edge between two places, whichever vertices lie there.
    std::uint64_t edge_of(std::uint32_t a, std::uint32_t b) const {
        const auto [low, high] = std::minmax(places_[a], places_[b]);
        return std::uint64_t{low} << 32 | high;
    }

    /// Notes the edges that are too long for one of the triangles at them. @return whether there are any
    bool mark() {
        marked_.clear();
        for (std::size_t t = 0; t < triangle_count(); ++t) {
            const Triangle v = triangle(t);
            const double limit = kLongest * std::max(distance_to(positions_[v[0]], positions_[v[1]], positions_[v[2]]), kNear);
            for (std::size_t i = 0; i < 3; ++i)
                if (glm::distance(positions_[v[i]], positions_[v[(i + 1) % 3]]) > limit) marked_.insert(edge_of(v[i], v[(i + 1) % 3]));
        }
        return !marked_.empty();
    }

    void halve() {
        std::vector<std::uint32_t> next;
        middles_.clear();
        for (std::size_t t = 0; t < triangle_count(); ++t) split(triangle(t), next);
        result_.indices = std::move(next);
    }

    std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
        const std::uint64_t edge = std::uint64_t{std::min(a, b)} << 32 | std::max(a, b);
        const auto [entry, is_new] = middles_.try_emplace(edge, static_cast<std::uint32_t>(positions_.size()));
        if (is_new) {
            // The same sum, rounded alike, for other vertices in the same places.
            positions_.push_back(0.5 * positions_[a] + 0.5 * positions_[b]);
            add_place(positions_.back());
            result_.added.push_back({a, b});
        }
        return entry->second;
    }

    /// Into one to four triangles of the same winding.
    void split(Triangle t, std::vector<std::uint32_t>& out) {
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) { out.insert(out.end(), {a, b, c}); };
        std::array<bool, 3> cut{};  // edge i runs from corner i to the next
        for (std::size_t i = 0; i < 3; ++i) cut[i] = marked_.contains(edge_of(t[i], t[(i + 1) % 3]));
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
    std::unordered_map<glm::dvec3, std::uint32_t, HashPlace> place_ids_;
    std::vector<std::uint32_t> places_;                         ///< [vertex]
    std::unordered_set<std::uint64_t> marked_;                  ///< edges by place, of this round
    std::unordered_map<std::uint64_t, std::uint32_t> middles_;  ///< edges by vertex, of this round
    Subdivision result_;
};

}  // namespace

Subdivision subdivide_near_origin(std::vector<glm::dvec3>& positions, const std::vector<std::uint32_t>& indices) {
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
        const glm::dvec3 &a = positions[indices[t]], &b = positions[indices[t + 1]], &c = positions[indices[t + 2]];
        const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
        // Hardly any triangle is so large that its distance matters.
        if (longest > kLongest * kNear && longest > kLongest * distance_to(a, b, c)) return Subdivider(positions, indices).run();
    }
    return {};
}

}  // namespace kadr
