#pragma once

#include <vector>

#include "device/tables/environment_tables.h"
#include "frame/snapshot.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// The punctual and area lights of a frame, those that have a surface first. What is out the whole time is left out.
template <class T>
class LightTablesOf {
public:
    void set(std::vector<kernels::LightOf<T>> keys, const std::vector<LightKeys>& lights);

    const std::vector<kernels::LightOf<T>>& keys() const { return keys_; }
    const std::vector<int>& first() const { return first_; }
    const std::vector<int>& key_count() const { return key_count_; }
    /// Fills in what is known of the lights; points to the tables.
    void fill(kernels::LightSetOf<T>& lights) const;

private:
    std::vector<kernels::LightOf<T>> keys_;
    std::vector<int> first_, key_count_;
    int visible_count_ = 0;
};
using LightTables = LightTablesOf<float>;

/// Fills in what is known of the environment; points to its tables.
template <class T>
void fill_environment(const EnvironmentSnapshot& seen, const EnvironmentTables& environment, kernels::LightSetOf<T>& lights);

}  // namespace kadr
