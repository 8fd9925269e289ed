#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "scene/scene.h"

namespace kadr {

/// What is known of a geometry before it is read.
struct GeometryOutline {
    std::size_t vertices = 0, corners = 0;  ///< of the accessors; corners: three a triangle, but for strips and fans
    bool normals = false, tangents = false, colors = false, skin = false;
    std::array<bool, 2> uv{};
    std::size_t targets = 0;                ///< morph targets
};

/// Glimpse of the files of a shot: trees of nodes, materials, lights, cameras, clips. Geometries and textures have a name
/// and nothing else, skins have no matrices.
struct SceneOutline {
    Scene scene;
    std::vector<GeometryOutline> geometries;  ///< parallel to the scene's
};

/// What is read of a geometry beside positions, triangles and normals.
struct GeometryNeeds {
    bool wanted = false;     ///< false: nothing of it
    std::array<bool, 2> uv{};
    bool tangents = false;   ///< where a normal texture needs them
    bool colors = false, skin = false, targets = false;
};

/// What of its files a shot needs: nothing else is read, and nothing else is in the scene.
struct SceneNeeds {
    std::vector<GeometryNeeds> geometries;                     ///< [geometry of the outline]
    std::vector<std::array<bool, kTextureUses>> textures;      ///< [material][TextureUse]
    std::vector<bool> skins;                                   ///< [skin]
};

/// Needs of who wants to see all that the files hold.
SceneNeeds everything_of(const SceneOutline& outline);

}  // namespace kadr
