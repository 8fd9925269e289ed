#pragma once

#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace kadr::stress {

struct Stage;

/// A value that Kadr refuses with exit code 2, and a part of what it says.
struct Refusal {
    double value = 0;
    std::string_view message;
};

/// One quantity that is swept: everything else in its shots is ordinary.
struct Axis {
    std::string_view name, unit = {}, meaning;
    std::vector<double> values;          ///< ascending, all different
    std::vector<double> quick;           ///< those of a short sweep, `ordinary` among them
    double ordinary = 0;                 ///< the value whose shot asks nothing unusual
    bool same_picture = false;           ///< the picture is the same for every value, but for the noise of its samples
    std::string_view limit = {};            ///< what the files themselves lose, which no renderer can mend; empty: nothing
    std::vector<Refusal> refusals = {};     ///< of values that Kadr does not take
    /// What is stated to be safe: a cell in here that is not sound is a fault. Found by the sweep (`kadr stress`).
    double safe_low = -std::numeric_limits<double>::infinity(), safe_high = std::numeric_limits<double>::infinity();
    void (*apply)(Stage& stage, double value) = nullptr;
};

/// Every axis, in the order of a report.
std::span<const Axis> axes();
/// @throws InputError  for an unknown name, with "did you mean"
const Axis& axis_of(std::string_view name);

/// A point of a sweep: a value of one axis, or of two at once.
struct Cell {
    const Axis* axis = nullptr;
    double value = 0;
    const Axis* second = nullptr;        ///< may be null
    double second_value = 0;             ///< unused without `second`
};

/// Whether all its values are stated to be safe.
bool is_safe(const Cell& cell);

/// "distance_10000", "distance_10000_spin_1000": part of file names.
std::string name_of(const Cell& cell);
/// What Kadr answers instead of rendering the cell, or empty.
std::string_view refusal_of(const Cell& cell);

/// The cells of one axis, ascending.
std::vector<Cell> cells_of(const Axis& axis, bool quick);
/// Cells of pairs of axes whose errors may add up: a screw on a terrain far from the origin, a spin far away.
std::vector<Cell> pair_cells(bool quick);

/// Writes the shot of a cell (NAME.yaml) and its glTF file (NAME.gltf, NAME.bin) into a folder, which is created. They are
/// ordinary input: `kadr render` takes them.
/// @return the shot file  @throws RenderError  when a file cannot be written
std::filesystem::path write_shot(const Cell& cell, const std::filesystem::path& folder);
std::filesystem::path write_shot(const Axis& axis, double value, const std::filesystem::path& folder);

}  // namespace kadr::stress
