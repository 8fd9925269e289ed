#pragma once

#include <span>
#include <vector>

#include "kernels/math/vec.h"

namespace kadr {

/// What a ray meets. Places are relative to the snapshot's render origin.
struct SurfaceHit {
    int instance = -1, primitive = -1;  ///< of the snapshot, of its mesh; -1: nothing was met
    double u = 0, v = 0;                ///< weights of the triangle's second and third corner
    double distance_m = 0;              ///< from where the device starts the ray
    kernels::Vec3<double> position{0, 0, 0};
    kernels::Vec3<double> normal{0, 0, 0};  ///< unit, geometric, on the viewer's side
    bool met() const { return instance >= 0; }
};

/// A ray from a surface that a camera ray met, as next-event estimation sends them: from where the device starts it.
struct SurfaceRay {
    SurfaceHit from;
    kernels::Vec3f to_viewer, direction;  ///< unit
    float distance_m = 0;
};

/// A ray from such a surface to a point of a light, as next-event estimation samples it there.
struct LightRay {
    SurfaceHit from;
    kernels::Vec3f to_viewer;      ///< unit
    int light = 0;                 ///< of the device's lights, see Probe::light_count
    kernels::Vec3f u{0, 0, 0};     ///< random numbers in [0, 1): x and y the point, z which emissive triangle
};

enum class LightSight : char {
    seen,
    hidden,       ///< something opaque lies in between
    not_towards,  ///< the light sends nothing here, or the surface faces away from it
};

/// Single rays on a device, answered with what its renderer would take: how devices are compared beneath their pictures.
/// Asks about the snapshot that the device was given last.
class Probe {
public:
    virtual ~Probe() = default;
    /// Pinhole rays through the film. @param film_px  x right, y down  @param time  in [0, 1] of the shutter
    virtual std::vector<SurfaceHit> look(std::span<const kernels::Vec2f> film_px, double time) = 0;
    /// Whether something opaque lies on each ray before its distance.
    virtual std::vector<char> occluded(std::span<const SurfaceRay> rays, double time) = 0;
    /// Lights of the snapshot that shine; all emissive triangles are one, the last. 0 on devices that answer no rays to lights.
    virtual int light_count() const { return 0; }
    virtual std::vector<LightSight> towards_lights(std::span<const LightRay>, double /*time*/) { return {}; }
};

}  // namespace kadr
