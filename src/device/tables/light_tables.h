#pragma once

#include <vector>

#include "device/tables/environment_tables.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The punctual and area lights of a frame, those that have a surface first.
class LightTables {
public:
    void set(const SceneSnapshot& snapshot);

    const std::vector<kernels::Light>& keys() const { return keys_; }
    const std::vector<int>& first() const { return first_; }
    const std::vector<int>& key_count() const { return key_count_; }
    /// Fills in what is known of the lights; points to the tables.
    void fill(kernels::LightSet& lights) const;

private:
    std::vector<kernels::Light> keys_;
    std::vector<int> first_, key_count_;
    int visible_count_ = 0;
};

/// Fills in what is known of the environment; points to its tables.
void fill_environment(const SceneSnapshot& snapshot, const EnvironmentTables& environment, kernels::LightSet& lights);

}  // namespace kadr
