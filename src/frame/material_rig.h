#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "frame/clip_offsets.h"
#include "frame/property_rig.h"

namespace kadr {

/// Materials over time. An entry of the shot that changes a material of its file, or whose clips do, has a copy of its
/// own at the end of the table, so that other entries of the file keep theirs; where copies of the entry play the clips at
/// other times, one for each clip offset.
class MaterialRig {
public:
    MaterialRig() = default;
    /// @pre check_appearance has passed for every entry
    /// @throws InputError  where copies of an entry would need too many materials of their own
    MaterialRig(const Shot& shot, const Scene& scene, const PropertyRig& properties, const ClipOffsets& offsets);

    /// The place in the table of a primitive's material in an entry: that of the entry's variant, and its own copy.
    int material_of(int entry, const MeshPrimitive& primitive) const;
    /// The place in the table of a material, as material_of has it, in a copy that plays its clips with an offset.
    std::uint32_t material_in_copy(std::uint32_t material, double clip_offset_s) const;

    /// Index into Scene::materials of what a material of the table is, or was made from.
    int source_of(std::uint32_t material) const;

    /// The whole table at a time; empty where the scene's own serves.
    std::vector<kernels::Material> table(double time_s) const;
    /// Whether a material of the table ever sends out light.
    bool may_emit(std::uint32_t material) const;
    /// Whether it ever shines on other things: what is unlit emits for the eye alone.
    bool may_light(std::uint32_t material) const;

    /// Whether the middle of an interval cannot stand for all of it: a factor with whose square radiance may grow
    /// changes by more than 1/8 (the mean of its square is then off by more than 1/768), a texture moves by more than
    /// 1/256 of its size, or emission bends by more than a thousandth.
    bool changes_fast(double begin_s, double end_s) const;
    std::vector<double> discontinuities(double begin_s, double end_s) const;

private:
    /// Materials of the table that are not the scene's: one that is changed, at every clip offset that makes a difference.
    struct Own {
        int original = -1;  ///< index into Scene::materials
        bool blends = false;  ///< the shot gives its alpha
        std::vector<DrivenProperty> driven = {};  ///< in the order in which they apply
        std::vector<double> offsets_s = {0};      ///< ascending
        std::size_t first = 0;                    ///< place in the table of the first of them
    };
    const kernels::Material& original_of(std::uint32_t material) const;
    static bool put_out(const Own& own);
    void add_entry(const Shot& shot, std::size_t entry, const PropertyRig& properties, const std::vector<double>& offsets_s);
    const Own* own_at(std::uint32_t material) const;  ///< null: the scene's
    kernels::Material evaluate(const Own& own, double time_s, double clip_offset_s) const;

    const Scene* scene_ = nullptr;
    std::vector<int> variant_;                    ///< [entry] index into SceneFile::variants; -1: none
    std::map<std::pair<int, int>, int> copy_of_;  ///< (entry, material of the scene) -> place in the table
    std::vector<Own> own_;                        ///< behind the scene's materials, in the order of the table
};

/// Checks the names of an entry's variant and materials.
/// @throws InputError  with "did you mean"
void check_appearance(const Scene& scene, std::size_t entry, const SceneSpec& spec);

}  // namespace kadr
