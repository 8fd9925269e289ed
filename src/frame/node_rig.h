#pragma once

#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "frame/node_pose.h"
#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

/// What an entry of the shot's `scenes` means for the nodes of its file.
struct BoundScene {
    struct Override {
        int node = -1;
        const NodeOverride* spec = nullptr;
    };
    std::vector<PlayingLayer> layers;
    std::vector<Override> overrides;
    std::vector<int> hidden;  ///< nodes left out, with all below them
};

/// The node trees of a shot's scenes, laid out for evaluation at many times: parents before children, tracks that
/// never change folded into constants, and only what moves evaluated anew.
///
/// `clip_offset_s` of the functions below is added to the shot time before it becomes the time of a clip: copies of a
/// scene play its clips earlier or later with it. It shifts clips alone; tracks of the shot keep to the shot's time.
class NodeRig {
public:
    /// @param scenes  one per scene file; the shot's overrides are referred to, not copied
    NodeRig(const Shot& shot, const Scene& scene, const std::vector<BoundScene>& scenes);

    bool moves(int node) const { return moving_[index(node)]; }  ///< at any time of the shot
    /// From a root of its file's default scene, with nothing hidden on the way.
    bool reachable(int node) const { return reachable_[index(node)]; }
    bool hidden(int node) const { return hidden_[index(node)]; }  ///< itself, or something above it
    int file_of(int node) const { return file_[index(node)]; }
    /// Layers of all scenes; those of a file lie together. What else clips animate refers to them (LayeredTrack).
    Layers layers() const { return layers_; }
    int first_layer_of(int file) const { return files_[index(file)].first_layer; }
    int layer_count_of(int file) const { return files_[index(file)].layer_count; }
    bool moves_itself(int node) const;  ///< a clip or the shot changes its own transform over time
    /// What moves a node; null where neither a clip nor the shot says anything of it.
    const NodePose* pose(int node) const { return pose_index_[index(node)] < 0 ? nullptr : &poses_[index(pose_index_[index(node)])]; }

    glm::dmat4 scene_transform(int file, double time_s) const;  ///< world_from_scene
    glm::dmat4 node_transform(int node, double time_s, double clip_offset_s = 0) const;  ///< world_from_node
    glm::dmat4 local_transform(int node, double time_s, double clip_offset_s = 0) const;  ///< parent_from_node
    /// Without the transform of the scene: what copies of the scene share.
    glm::dmat4 scene_from_node(int node, double time_s, double clip_offset_s = 0) const;
    /// Whether clips jump somewhere, so that copies which play them at other times jump at other times.
    bool clips_jump() const;
    std::vector<glm::dmat4> all_transforms(double time_s, double clip_offset_s = 0) const;

    /// Some nodes and their moving ancestors, parents first.
    struct Selection {
        std::vector<int> nodes;
        std::vector<int> parent_slot;  ///< into nodes; -1: the parent does not move, or the node is a root
        int slot_of(int node) const;   ///< for a node of the selection
        std::vector<std::pair<int, int>> slots;  ///< (node, slot) in ascending order of nodes
    };
    Selection select(std::span<const int> nodes) const;

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
    struct FileMotion {
        const TransformTrack* transform = nullptr;
        bool moves = false;
        int first_layer = 0, layer_count = 0;
    };
    template <class T>
    struct StepTrack {
        int layer = 0;
        const Track<T>* track = nullptr;
    };

    static std::size_t index(int i) { return static_cast<std::size_t>(i); }
    void order_nodes(const std::vector<BoundScene>& scenes);
    void bind_layers(const std::vector<BoundScene>& scenes);
    void bind_clip(const Clip& clip, int layer);
    void place_nodes();
    template <class T>
    void note_jumps(const LayeredTrack<T>& track, std::vector<StepTrack<T>>& steps);
    NodePose& pose_of(int node);
    Activity own_activity(int node, LayerWindows windows, double begin_s, double end_s, double clip_offset_s) const;

    const Scene* scene_;
    std::vector<FileMotion> files_;
    std::vector<PlayingLayer> layers_;
    std::vector<bool> jumps_at_seam_;  ///< [layer]
    std::vector<StepTrack<glm::dvec3>> vector_steps_;
    std::vector<StepTrack<glm::dquat>> rotation_steps_;
    std::vector<int> order_, rank_, file_;
    std::vector<bool> hidden_, reachable_, moving_;
    std::vector<int> pose_index_;  ///< into poses_; -1: the file's own transform
    std::vector<NodePose> poses_;
    std::vector<int> mixed_rotations_;  ///< poses in which a rotation has a weight below 1 or several layers
    std::vector<glm::dmat4> local_, world_;  ///< of what does not move
};

}  // namespace kadr
