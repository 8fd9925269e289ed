#pragma once

#include <optional>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>
#include <glm/vec3.hpp>

#include "shot/shot.h"
#include "stress/mesh.h"

namespace kadr::stress {

struct Material {
    glm::dvec3 base_color{0.5};
    double metallic = 0, roughness = 1;
    double emission = 0;        ///< radiance, of every colour
    std::optional<double> ior;  ///< by KHR_materials_ior, which the file then requires
};

/// A value of an object at a time of the shot: metres, factors, degrees or a quaternion x y z w.
struct MotionKey {
    double time_s = 0;
    std::vector<double> value;
};

/// Tracks that replace parts of an object's transform.
struct Motion {
    std::vector<MotionKey> translate, rotate, scale;  ///< linear between the keys; empty: none
    std::vector<MotionKey> angle;                     ///< degrees about +z, instead of rotate
    bool in_clip = false;                             ///< translate, rotate and scale stand in the glTF file, not in the shot
    bool none() const { return translate.empty() && rotate.empty() && scale.empty() && angle.empty(); }
};

/// A mesh and where it stands on the stage.
struct Object {
    std::string name;
    Mesh mesh;
    Material material;
    glm::dvec3 translate{0};
    glm::dquat rotate{1, 0, 0, 0};
    glm::dvec3 scale{1};
    std::optional<std::vector<glm::dvec3>> copies;  ///< offsets in the object's own coordinates, by EXT_mesh_gpu_instancing; absent: one
    Motion motion;
};

/// Scales and then moves.
struct Placement {
    double scale = 1;
    glm::dvec3 offset{0};
    glm::dvec3 of(const glm::dvec3& p) const { return offset + scale * p; }
};

struct Camera {
    glm::dvec3 position{0}, look_at{0};
    double vertical_fov_deg = 30;
    bool authored = false;  ///< stands in the glTF file
};

struct Lamp {
    LightKind kind = LightKind::point;
    double strength = 1;  ///< in the kind's unit: lux, candela, nit
    glm::dvec3 position{0}, target{0};
    double range_m = 0;   ///< 0: infinite
    double radius_m = 0;
    double inner_deg = 0, outer_deg = 45;
    double diameter_deg = 0;  ///< directional: its apparent size
    double side_m = 1;        ///< area: of the square
};

/// A small shot from which files are written: everything that an axis may change.
struct Stage {
    std::string name;
    std::vector<Object> objects;
    Camera camera;
    Lamp key;
    double sky = 0.1;         ///< radiance from everywhere
    double sky_sun = 0;       ///< times `sky`: of one pixel of an environment image; 0: no image
    double exposure_stops = 0;
    Placement vertices;       ///< the meshes' own coordinates, camera and light along with them
    Placement world;          ///< the root node, camera and light along with it
    std::string fps = "24";   ///< as the shot file writes it
    int frame = 0;            ///< the only one
    double shutter_s = 0;     ///< from the frame's time on
    int width = 64, height = 36, samples = 4;

    /// @pre there is one of that name
    Object& object(const std::string& object_name);
    void remove(const std::string& object_name);
};

/// A ball just above the floor of half a box, a block that stands on it, a small lamp, and faint light from everywhere; about
/// 8 m wide.
Stage base_stage();

}  // namespace kadr::stress
