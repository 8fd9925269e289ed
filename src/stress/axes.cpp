#include <algorithm>
#include <iterator>

#include <fmt/format.h>

#include "base/error.h"
#include "base/text.h"
#include "output/atomic_file.h"
#include "stress/axis_groups.h"
#include "stress/gltf_file.h"
#include "stress/shot_file.h"
#include "stress/stage.h"

namespace kadr::stress {

namespace {

std::vector<Axis> all_axes() {
    std::vector<Axis> all;
    for (const auto group : {place_axes, surface_axes, light_axes, motion_axes}) std::ranges::move(group(), std::back_inserter(all));
    return all;
}

/// Values of two axes whose errors may add up.
struct Pair {
    std::string_view first;
    std::vector<double> values;
    std::string_view second;
    std::vector<double> second_values;
};

std::vector<Pair> pairs() {
    return {
        {"scale", {1e-3}, "size_ratio", {1e7}},  // a screw of 1 mm on a terrain of 10 km
        {"distance", {1e4, 1e7}, "size_ratio", {1e3, 1e7}},
        {"distance", {1e4, 1e7}, "scale", {1e-6, 1e6}},
        {"distance", {1e4, 1e7}, "telephoto", {1e4}},
        {"distance", {1e4, 1e7}, "gap", {1e-6, 1e-3}},
        {"distance", {1e4, 1e7}, "thickness", {1e-4}},
        {"distance", {1e4, 1e7}, "elevation", {1e-3}},
        {"distance", {1e4, 1e7}, "spin", {1e3, 1e6}},
        {"distance", {1e4, 1e7}, "travel", {1e3}},
        {"scale", {1e-9, 1e9}, "thickness", {1e-4}},
        {"scale", {1e-9, 1e9}, "spin", {1e3}},
        {"size_ratio", {1e7}, "elevation", {1e-3}},
        {"size_ratio", {1e7}, "spin", {1e3}},
        {"vertex_distance", {1e2, 1e4}, "distance", {1e7}},
    };
}

std::vector<Cell> product(const Pair& pair) {
    std::vector<Cell> cells;
    for (const double value : pair.values)
        for (const double second : pair.second_values) cells.push_back({&axis_of(pair.first), value, &axis_of(pair.second), second});
    return cells;
}

std::string_view refusal_of(const Axis* axis, double value) {
    if (!axis) return {};
    const auto found = std::ranges::find(axis->refusals, value, &Refusal::value);
    return found == axis->refusals.end() ? std::string_view() : found->message;
}

std::string name_of(const Axis& axis, double value) { return fmt::format("{}_{}", axis.name, format_number(value)); }

}  // namespace

std::span<const Axis> axes() {
    static const std::vector<Axis> all = all_axes();
    return all;
}

const Axis& axis_of(std::string_view name) {
    const auto found = std::ranges::find(axes(), name, &Axis::name);
    if (found != axes().end()) return *found;
    std::vector<std::string> names;
    for (const Axis& axis : axes()) names.emplace_back(axis.name);
    const auto near = nearest_name(name, names);
    throw InputError(fmt::format("there is no axis '{}'", name), near ? fmt::format("did you mean {}?", *near) : fmt::format("expected one of {}", fmt::join(names, ", ")));
}

std::string name_of(const Cell& cell) {
    const std::string first = name_of(*cell.axis, cell.value);
    return cell.second ? first + "_" + name_of(*cell.second, cell.second_value) : first;
}

bool is_safe(const Cell& cell) {
    const auto within = [](const Axis& axis, double value) { return value >= axis.safe_low && value <= axis.safe_high; };
    return within(*cell.axis, cell.value) && (!cell.second || within(*cell.second, cell.second_value));
}

std::string_view refusal_of(const Cell& cell) {
    const std::string_view first = refusal_of(cell.axis, cell.value);
    return first.empty() ? refusal_of(cell.second, cell.second_value) : first;
}

std::vector<Cell> cells_of(const Axis& axis, bool quick) {
    std::vector<Cell> cells;
    for (const double value : quick ? axis.quick : axis.values) cells.push_back({&axis, value});
    return cells;
}

std::vector<Cell> pair_cells(bool quick) {
    std::vector<Cell> cells;
    for (const Pair& pair : pairs()) {
        const std::vector<Cell> all = product(pair);
        if (quick) cells.push_back(all.back());
        else std::ranges::copy(all, std::back_inserter(cells));
    }
    return cells;
}

std::filesystem::path write_shot(const Cell& cell, const std::filesystem::path& folder) {
    Stage stage = base_stage();
    stage.name = name_of(cell);
    cell.axis->apply(stage, cell.value);
    if (cell.second) cell.second->apply(stage, cell.second_value);
    create_folder_of(folder / stage.name);
    write_gltf(stage, folder);
    return write_shot_file(stage, folder);
}

std::filesystem::path write_shot(const Axis& axis, double value, const std::filesystem::path& folder) { return write_shot(Cell{&axis, value}, folder); }

}  // namespace kadr::stress
