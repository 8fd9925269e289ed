#include "device/tables/light_tables.h"

#include <algorithm>
#include <utility>

#include "kernels/light/light.h"

namespace kadr {
namespace {

template <class T>
bool is_zero(const kernels::Vec3<T>& v) {
    return v.x == 0 && v.y == 0 && v.z == 0;
}

/// Whether a light is out the whole time.
template <class T>
bool is_out(const std::vector<kernels::LightOf<T>>& keys, const LightKeys& light) {
    const auto first = keys.begin() + light.first;
    return std::all_of(first, first + light.count, [](const kernels::LightOf<T>& key) { return is_zero(key.radiance); });
}

}  // namespace

template <class T>
void LightTablesOf<T>::set(std::vector<kernels::LightOf<T>> keys, const std::vector<LightKeys>& lights) {
    keys_ = std::move(keys);
    first_.clear();
    key_count_.clear();
    visible_count_ = 0;
    for (const bool with_surface : {true, false})
        for (const LightKeys& light : lights) {
            if (kernels::is_delta(keys_[light.first]) == with_surface || is_out(keys_, light)) continue;
            first_.push_back(static_cast<int>(light.first));
            key_count_.push_back(static_cast<int>(light.count));
            visible_count_ += with_surface ? 1 : 0;
        }
}

template <class T>
void LightTablesOf<T>::fill(kernels::LightSetOf<T>& lights) const {
    lights.keys = keys_.data();
    lights.first = first_.data();
    lights.key_count = key_count_.data();
    lights.count = static_cast<int>(first_.size());
    lights.visible_count = visible_count_;
}

template <class T>
void fill_environment(const EnvironmentSnapshot& seen, const EnvironmentTables& environment, kernels::LightSetOf<T>& lights) {
    lights.environment = seen.radiance;
    lights.environment_visible = seen.visible;
    lights.has_map = !environment.empty() && !is_zero(seen.radiance);
    lights.map = environment.map();
    lights.map.factor = seen.radiance;
    lights.map.rotate_rad = seen.rotate_rad;
    lights.map.average_luminance *= kernels::luminance(seen.radiance);
}

template class LightTablesOf<float>;
template class LightTablesOf<double>;
template void fill_environment(const EnvironmentSnapshot&, const EnvironmentTables&, kernels::LightSetOf<float>&);
template void fill_environment(const EnvironmentSnapshot&, const EnvironmentTables&, kernels::LightSetOf<double>&);

}  // namespace kadr
