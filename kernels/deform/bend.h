// Bending a mesh where it lies: vertices and tangents of all keys from what it is at rest, its morph targets, and the
// poses of the keys. What a GPU gets of a frame is poses alone.
#pragma once

#include "kernels/deform/skinning.h"

namespace kadr::kernels {

/// What a morph target adds to one vertex.
struct MorphEntry {
    unsigned target;
    Vec3f position, normal, tangent;
};
/// What a morph target changes at all.
namespace morph_part {
inline constexpr unsigned char kPosition = 1, kNormal = 2, kTangent = 4;
}

/// A mesh at rest. Pointers are device addresses; null: the mesh has none.
struct RestMesh {
    const Vec3f *positions, *normals;  ///< [vertex]
    const Vec4f* tangents;             ///< [vertex]
    const Vec2f* uv;                   ///< [vertex] of set 0
    const unsigned short* joints;      ///< [vertex][slot]
    const float* joint_weights;        ///< [vertex][slot]
    const unsigned* morph_first;       ///< [vertex + 1] into morphs
    const MorphEntry* morphs;          ///< of each vertex by ascending target
    const unsigned char* morph_parts;  ///< [target] morph_part bits
    unsigned vertex_count;
    int slots;  ///< joints a vertex; 0: the first joint carries all
};

/// The poses of the keys. `joint_count` 1: it carries all.
struct BendPoses {
    const Affine* matrices;                      ///< [key][joint]; of linear skinning, and where one joint carries all
    const DualQuaternionJoint* dual_quaternions; ///< [key][joint]; null: linear skinning
    const float* morph_weights;                  ///< [key][target]
    const unsigned char* stretches;              ///< [key] of dual quaternions: a joint does more than move
    unsigned joint_count, target_count, key_count;
};

/// A launch: one thread a vertex of a key.
struct BendParams {
    RestMesh rest;
    BendPoses poses;
    Vertex* vertices;  ///< [key][vertex]
    Vec4f* tangents;   ///< [key][vertex]; null: the mesh has none
};
static_assert(sizeof(MorphEntry) == 40 && sizeof(BendParams) == 144, "shared with the host");

inline constexpr unsigned kBendBlock = 128;  ///< threads of a block

/// A vertex after its morph targets.
struct MorphedVertex {
    Vec3f position, normal, tangent;
};

SHARED_FN MorphedVertex morphed(const RestMesh& mesh, const float* weights, unsigned v) {
    MorphedVertex m{mesh.positions[v], mesh.normals ? mesh.normals[v] : Vec3f{0, 0, 0}, {0, 0, 0}};
    if (mesh.tangents) m.tangent = {mesh.tangents[v].x, mesh.tangents[v].y, mesh.tangents[v].z};
    if (!mesh.morph_first) return m;
    for (unsigned i = mesh.morph_first[v]; i < mesh.morph_first[v + 1]; ++i) {
        const MorphEntry& e = mesh.morphs[i];
        const float weight = weights[e.target];
        if (weight == 0) continue;
        const unsigned parts = mesh.morph_parts[e.target];
        // What is absent is not added: a sum with zero may change the sign of a zero.
        if (parts & morph_part::kPosition) m.position = m.position + e.position * weight;
        if (mesh.normals && (parts & morph_part::kNormal)) m.normal = m.normal + e.normal * weight;
        if (mesh.tangents && (parts & morph_part::kTangent)) m.tangent = m.tangent + e.tangent * weight;
    }
    return m;
}

/// What carries a vertex at a key.
SHARED_FN Affine carrier_of(const BendParams& params, unsigned key, unsigned v) {
    const BendPoses& poses = params.poses;
    const unsigned long first = static_cast<unsigned long>(key) * poses.joint_count;
    if (poses.joint_count == 1 || params.rest.slots == 0) return poses.matrices[first];
    const unsigned long slot = static_cast<unsigned long>(v) * static_cast<unsigned>(params.rest.slots);
    const unsigned short* joint = params.rest.joints + slot;
    const float* weight = params.rest.joint_weights + slot;
    if (!poses.dual_quaternions) return skinning::blend(poses.matrices + first, joint, weight, params.rest.slots);
    return poses.stretches[key]
               ? skinning::stretched_blend(poses.dual_quaternions + first, joint, weight, params.rest.slots)
               : skinning::rigid_blend(poses.dual_quaternions + first, joint, weight, params.rest.slots);
}

/// One vertex of one key. @param i  key * vertex_count + vertex
SHARED_FN void bend_vertex(const BendParams& params, unsigned long i) {
    const RestMesh& mesh = params.rest;
    const unsigned key = static_cast<unsigned>(i / mesh.vertex_count), v = static_cast<unsigned>(i % mesh.vertex_count);
    const MorphedVertex m =
        morphed(mesh, params.poses.morph_weights + static_cast<unsigned long>(key) * params.poses.target_count, v);
    const Affine a = carrier_of(params, key, v);
    params.vertices[i] = skinning::carried_vertex(a, m.position, m.normal, mesh.uv ? mesh.uv[v] : Vec2f{0, 0});
    if (params.tangents) params.tangents[i] = skinning::carried_tangent(a, m.tangent, mesh.tangents[v].w);
}

/// The box around a triangle over the whole shutter.
struct TriangleBox {
    Vec3f low, high;
};

/// Around all keys of a triangle's corners: between keys they go straight, so they stay within. A hair larger, by a few
/// units in the last place of the largest coordinate: what rounding moves a ray in the mesh's space.
SHARED_FN TriangleBox box_of(const Geometry& g, unsigned triangle) {
    const unsigned* corners = g.indices + 3 * static_cast<unsigned long>(triangle);
    TriangleBox box{g.vertices[corners[0]].position, g.vertices[corners[0]].position};
    for (unsigned k = 0; k < (g.key_count > 1 ? g.key_count : 1u); ++k)
        for (int c = 0; c < 3; ++c) {
            const Vec3f p = g.vertices[static_cast<unsigned long>(k) * g.vertex_count + corners[c]].position;
            box.low = {min(box.low.x, p.x), min(box.low.y, p.y), min(box.low.z, p.z)};
            box.high = {max(box.high.x, p.x), max(box.high.y, p.y), max(box.high.z, p.z)};
        }
    const Vec3f size{max(abs(box.low.x), abs(box.high.x)), max(abs(box.low.y), abs(box.high.y)),
                     max(abs(box.low.z), abs(box.high.z))};
    const float by = 1e-6f * max(size.x, max(size.y, size.z));
    return {{box.low.x - by, box.low.y - by, box.low.z - by}, {box.high.x + by, box.high.y + by, box.high.z + by}};
}

/// A launch: one thread a triangle.
struct BoxParams {
    Geometry geometry;
    TriangleBox* boxes;  ///< [triangle]
};
static_assert(sizeof(BoxParams) == 72, "shared with the host");

}  // namespace kadr::kernels
