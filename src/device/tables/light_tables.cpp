#include "device/tables/light_tables.h"

#include "kernels/light/light.h"

namespace kadr {

void LightTables::set(const SceneSnapshot& snapshot) {
    keys_ = snapshot.light_keys;
    first_.clear();
    key_count_.clear();
    visible_count_ = 0;
    for (const bool with_surface : {true, false})
        for (const LightKeys& light : snapshot.lights) {
            if (kernels::is_delta(keys_[light.first]) == with_surface) continue;
            first_.push_back(static_cast<int>(light.first));
            key_count_.push_back(static_cast<int>(light.count));
            visible_count_ += with_surface ? 1 : 0;
        }
}

void LightTables::fill(kernels::LightSet& lights) const {
    lights.keys = keys_.data();
    lights.first = first_.data();
    lights.key_count = key_count_.data();
    lights.count = static_cast<int>(first_.size());
    lights.visible_count = visible_count_;
}

void fill_environment(const SceneSnapshot& snapshot, const EnvironmentTables& environment, kernels::LightSet& lights) {
    lights.environment = snapshot.environment.radiance;
    lights.environment_visible = snapshot.environment.visible;
    lights.has_map = !environment.empty();
    lights.map = environment.map();
    lights.map.factor = snapshot.environment.radiance;
    lights.map.rotate_rad = snapshot.environment.rotate_rad;
    lights.map.average_luminance *= kernels::luminance(snapshot.environment.radiance);
}

}  // namespace kadr
