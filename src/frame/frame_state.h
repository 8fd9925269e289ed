#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anim/timing.h"
#include "scene/scene.h"
#include "shot/shot.h"

namespace kadr {

struct Bindings;

/// Names of the shot bound to the scene once: node references, clips, the frame range where the shot gives none.
/// Everything `kadr check` can say about a shot and its scenes beyond the shot's own grammar.
class BoundShot {
public:
    /// @throws InputError  with all unresolved names ("did you mean"), missing clips, a camera that is none, and
    ///         features the integrator does not have (area lights or an environment image under `direct`)
    BoundShot(const Shot& shot, const Scene& scene);

    const Shot& shot() const { return *shot_; }
    const Scene& scene() const { return *scene_; }
    /// The shot's timing with its frame range filled in.
    const Timing& timing() const { return timing_; }
    const Sequence& sequence() const { return sequence_; }
    const std::vector<Diagnostic>& warnings() const { return warnings_; }

    /// World transform (double) of every node of the scene at a time; [node].
    std::vector<glm::dmat4> node_transforms(double time_s) const;
    /// Nodes whose world transform never changes over the whole shot; [node].
    const std::vector<bool>& fixed_nodes() const { return fixed_; }
    /// Resolved node of a reference, an index into Scene::nodes; -1 for a scene's own root (see scene_of).
    int node_of(const NodeReference& reference) const;
    /// Resolved scene of a reference, an index into Scene::files.
    int scene_of(const NodeReference& reference) const;
    /// What the rest of frame/ reads (frame/bindings.h).
    const Bindings& bindings() const { return *bindings_; }

private:
    const Shot* shot_;
    const Scene* scene_;
    Timing timing_;
    Sequence sequence_;
    std::vector<bool> fixed_;
    std::shared_ptr<const Bindings> bindings_;  ///< never changes, so copies of a bound shot share it
    std::vector<Diagnostic> warnings_;
};

}  // namespace kadr
