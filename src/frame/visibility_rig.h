#pragma once

#include <map>
#include <optional>
#include <vector>

#include "frame/clip_offsets.h"
#include "frame/property_rig.h"

namespace kadr {

/// What is hidden when: scene entries by the shot, nodes by their file (KHR_node_visibility), by its clips and by the
/// shot. What is hidden hides all below it, lights included; cameras go on to see.
class VisibilityRig {
public:
    VisibilityRig() = default;
    /// @param scenes  one per scene entry
    VisibilityRig(const Shot& shot, const Scene& scene, const std::vector<BoundScene>& scenes, const PropertyRig& properties);

    /// Whether everything is always visible.
    bool idle() const { return switches_.empty(); }
    /// Whether a node, or something above it, is ever hidden.
    bool ever_hides(int node) const { return switch_of_[static_cast<std::size_t>(node)] >= 0; }

    /// Whether it, or something above it, is hidden at all times.
    bool never_shows(int node) const;

    /// The states of all switches at one time.
    class States {
    public:
        /// @param clip_offset_s  of the copy that the node is seen in
        bool visible(int node, double clip_offset_s = 0) const;

    private:
        friend class VisibilityRig;
        const VisibilityRig* rig_ = nullptr;
        double time_s_ = 0;
        std::vector<bool> on_;  ///< [switch] without an offset, with those above it
    };
    States at(double time_s) const;

    /// Times inside (begin, end) at which something is shown or hidden in any copy.
    std::vector<double> discontinuities(double begin_s, double end_s, const ClipOffsets& offsets) const;

private:
    /// A node, or an entry's root, that is hidden at some time.
    struct Switch {
        int above = -1;  ///< into switches_; always before this one
        int entry = -1;
        bool rest = true;
        std::optional<DrivenProperty> by_clip;
        const SwitchTrack* by_shot = nullptr;  ///< wins over clips and file
        bool on(double time_s, double clip_offset_s) const;
        bool ever_on() const;
        void add_discontinuities(double begin_s, double end_s, double clip_offset_s, std::vector<double>& times) const;
    };
    int entry_switch(int entry, const SceneSpec& spec);
    /// The switch of a node; none where it is always visible. @param by_shot  null: the shot says nothing of it
    static std::optional<Switch> switch_for(bool rest, const SwitchTrack* by_shot, const std::vector<DrivenProperty>& by_clip);
    using ByShot = std::map<int, const SwitchTrack*>;  ///< by node
    void add_tree(const Scene& scene, const ByShot& by_shot, const PropertyRig& properties, int entry, int root, int above);

    bool clips_switch_ = false;
    std::vector<Switch> switches_;
    std::vector<int> switch_of_;  ///< [node] the nearest at or above it; -1: none
};

}  // namespace kadr
