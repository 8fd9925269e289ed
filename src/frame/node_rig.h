#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// The node trees of a shot's scenes, laid out for evaluation at many times: parents before children, tracks that
/// never change folded into constants, and only what moves evaluated anew.
///
/// `clip_offset_s` of the functions below is added to the shot time before it becomes the time of a clip: copies of a
/// scene play its clips earlier or later with it. It shifts clips alone; tracks of the shot keep to the shot's time.
class NodeRig {
public:
    /// @param clips  indices into Scene::clips that play, one list per scene file
    NodeRig(const Shot& shot, const Scene& scene, const std::vector<std::vector<int>>& clips);

    bool moves(int node) const { return moving_[index(node)]; }       ///< at any time of the shot
    bool reachable(int node) const { return reachable_[index(node)]; } ///< from a root of its file's default scene
    int file_of(int node) const { return file_[index(node)]; }

    glm::dmat4 scene_transform(int file, double time_s) const;  ///< world_from_scene
    glm::dmat4 node_transform(int node, double time_s, double clip_offset_s = 0) const;  ///< world_from_node
    glm::dmat4 local_transform(int node, double time_s, double clip_offset_s = 0) const;  ///< parent_from_node
    std::vector<glm::dmat4> all_transforms(double time_s, double clip_offset_s = 0) const;

    /// Some nodes and their moving ancestors, parents first.
    struct Selection {
        std::vector<int> nodes;
        std::vector<int> parent_slot;  ///< into nodes; -1: the parent does not move, or the node is a root
        int slot_of(int node) const;   ///< for a node of the selection
        std::vector<std::pair<int, int>> slots;  ///< (node, slot) in ascending order of nodes
    };
    Selection select(std::span<const int> nodes) const;
    /// World transforms, parallel to selection.nodes.
    void evaluate(const Selection& selection, double time_s, std::vector<glm::dmat4>& world, double clip_offset_s = 0) const;

    /// How lively each selected node is during (begin, end): what its own tracks and those above it do.
    struct Activity {
        double turn_rad = 0;  ///< all turning added up: no rotation can exceed it
        int keys = 0;         ///< keys inside the interval
        int grid = 1;         ///< even segments on whose ends those keys fall; 1 where there is no such grid
    };
    std::vector<Activity> activity(const Selection& selection, double begin_s, double end_s, double clip_offset_s = 0) const;

    /// Times inside (begin, end) where a transform jumps.
    std::vector<double> discontinuities(double begin_s, double end_s, double clip_offset_s = 0) const;
    /// Keys inside (begin, end) of a node and everything above it.
    std::vector<double> key_times_of(int node, double begin_s, double end_s, double clip_offset_s = 0) const;

private:
    /// A node that a clip animates; a null track leaves the constant.
    struct Animated {
        glm::dvec3 translation{0}, scale{1};
        glm::dquat rotation{1, 0, 0, 0};
        const Track<glm::dvec3>* translation_track = nullptr;
        const Track<glm::dvec3>* scale_track = nullptr;
        const Track<glm::dquat>* rotation_track = nullptr;
    };
    struct FileMotion {
        const TransformTrack* transform = nullptr;
        bool moves = false;
        double start_s = 0, speed = 1;
        double clip_time(double time_s, double offset_s) const { return start_s + speed * (time_s + offset_s); }
        double shot_time(double clip_s, double offset_s) const { return (clip_s - start_s) / speed - offset_s; }
    };

    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    void order_nodes();
    void bind_clips(const std::vector<std::vector<int>>& clips);
    void bind_channels(const NodeChannels& channels);
    bool animates(int node) const;  ///< whether a clip changes its own transform over time
    Activity own_activity(int node, double begin_s, double end_s, double clip_offset_s) const;

    const Scene* scene_;
    std::vector<FileMotion> files_;
    std::vector<int> order_, rank_, file_;
    std::vector<bool> reachable_, moving_;
    std::vector<int> animated_index_;  ///< -1: not animated
    std::vector<Animated> animated_;
    std::vector<glm::dmat4> local_, world_;  ///< of what does not move
};

}  // namespace kadr
