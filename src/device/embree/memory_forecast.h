#pragma once

#include "frame/snapshot.h"

namespace kadr {

/// What the CPU's device takes for a frame, in bytes, beside the scene that it is given.
struct DeviceMemory {
    double vertices = 0;    ///< as the kernels fetch them: flattened ones in the world's coordinates, and those of instances
    double structures = 0;  ///< Embree's, over triangles
    double building = 0;    ///< more, while the largest of them is built
    double instances = 0;   ///< Embree's, their structure, and the tables of the kernels
    double instances_building = 0;  ///< more, while that structure is built
};

DeviceMemory forecast_device_memory(const Scene& scene, const SceneSnapshot& snapshot);

}  // namespace kadr
