#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "device/device.h"
#include "stress/axis.h"
#include "stress/ray_figures.h"

namespace kadr::stress {

/// Error of a picture against the reference's, which has the same samples: display values in [0, 1] after the shot's view.
struct PictureFigures {
    double mean = 0;      ///< mean absolute difference over pixels and R, G, B
    double largest = 0;
    double beyond = 0;    ///< share of pixels that differ by more than a step of eight bits, 1/255
};

struct CellResult {
    Cell cell;
    std::filesystem::path shot;
    std::string refused;                     ///< first line of what Kadr said instead of rendering; empty: rendered
    bool refusal_expected = false;           ///< it is what the axis says
    std::optional<PictureFigures> picture;   ///< absent: too large for the reference
    std::optional<RayFigures> rays;
    std::optional<PictureFigures> drift;     ///< the reference's picture against that of the axis' ordinary value, where both are to be the same
    std::uint64_t dropped_samples = 0, not_finite = 0;
    std::vector<std::string> warnings;       ///< said before rendering
    double seconds = 0;

    /// Nothing wrong: the picture within a step of eight bits, no ray that contradicts the reference, no sample lost.
    bool sound() const;
    /// Not sound although its values are stated to be safe.
    bool fault() const { return !sound() && is_safe(cell); }
};

struct EvaluateOptions {
    DeviceRequest device;
    RayCounts rays;
};

/// Renders cells and compares them with the reference. Keeps the ordinary picture of the axis at hand.
class Evaluator {
public:
    /// @param folder  the shots are written here
    Evaluator(EvaluateOptions options, std::filesystem::path folder);
    /// Bad input is a result; @throws RenderError, Interrupted
    CellResult evaluate(const Cell& cell);

private:
    struct Rendered;
    Rendered render(const std::filesystem::path& shot, CellResult& result) const;
    const Image& ordinary_picture(const Axis& axis);

    EvaluateOptions options_;
    std::filesystem::path folder_;
    const Axis* axis_ = nullptr;
    Image ordinary_;
};

}  // namespace kadr::stress
