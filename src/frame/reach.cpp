#include "frame/reach.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/text.h"
#include "frame/bindings.h"
#include "frame/problem.h"
#include "frame/snapshot.h"

namespace kadr {

namespace {

constexpr double kFarthest = 1e17;  // metres, and units of the render space
constexpr double kLargestRatio = 1e17;
constexpr double kSmallest = 1e-12;  // units: the cube of a scale has to be a float, or Embree finds no inverse

[[noreturn]] void refuse(const BoundShot& shot, std::uint32_t instance, double open_s, const std::string& what, std::string expected) {
    throw InputError(problem_of_node(shot, shot.bindings().instances[instance].seed->node, what, open_s, std::move(expected)));
}

/// Of the camera's keys, from the render origin.
double camera_reach_m(const SceneSnapshot& snapshot) {
    double farthest = 0;
    for (const kernels::CameraKey& key : snapshot.camera_keys)
        farthest = std::max(farthest, glm::length(glm::dvec3(key.position.x, key.position.y, key.position.z)));
    return farthest * snapshot.unit_m;
}

}  // namespace

void Reach::add(std::uint32_t instance, const Decomposition& place) {
    const glm::dvec3 size = glm::abs(place.scale);
    const double least = std::min({size.x, size.y, size.z}), far = glm::length(place.translation) + glm::length(size);
    if (far > farthest_m) farthest_m = far, farthest = instance;
    if (least < smallest_m) smallest_m = least, smallest = instance;
}

void Reach::add(const Reach& other) {
    if (other.farthest_m > farthest_m) farthest_m = other.farthest_m, farthest = other.farthest;
    if (other.smallest_m < smallest_m) smallest_m = other.smallest_m, smallest = other.smallest;
}

void check_reach(const BoundShot& shot, const SceneSnapshot& snapshot, const Reach& reach) {
    const double camera = camera_reach_m(snapshot), all = std::max({camera, reach.farthest_m, snapshot.unit_m}), limit_m = kFarthest * std::min(snapshot.unit_m, 1.0);
    if (!(camera <= limit_m))
        throw InputError(problem_at(shot.shot().camera.where, fmt::format("the camera is {:.3g} m from what it looks at, or moves that far, at {} s", camera, format_number(snapshot.open_s)),
                                    fmt::format("expected at most {:.0e} m", limit_m)));
    if (!(reach.farthest_m <= limit_m))
        refuse(shot, reach.farthest, snapshot.open_s, fmt::format("reaches {:.3g} m from the camera", reach.farthest_m), fmt::format("expected at most {:.0e} m", limit_m));
    if (reach.smallest_m < kSmallest * snapshot.unit_m)
        refuse(shot, reach.smallest, snapshot.open_s, fmt::format("is {:.3g} m large in a picture of {:.3g} m", reach.smallest_m, snapshot.unit_m),
               fmt::format("expected at least {:.0e} of what the picture shows; make it larger, or leave it out", kSmallest));
    if (reach.smallest_m * kLargestRatio < all)
        refuse(shot, reach.smallest, snapshot.open_s, fmt::format("is {:.3g} m large in a scene of {:.3g} m", reach.smallest_m, all),
               fmt::format("expected less than {:.0e} times its size; make it larger", kLargestRatio));
}

}  // namespace kadr
