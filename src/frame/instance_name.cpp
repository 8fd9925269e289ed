#include "frame/instance_name.h"

#include "frame/bindings.h"
#include "frame/references.h"

namespace kadr {

std::string node_path_of(const BoundShot& shot, const SnapshotInstance& instance) {
    const InstanceSeed* seed = &shot.bindings().seed_of(instance.id);
    const int file = shot.bindings().rig.file_of(seed->mesh_node);
    return node_path(shot.scene(), file, seed->mesh_node);
}

}  // namespace kadr
