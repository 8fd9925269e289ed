#include "stress/evaluate.h"

#include <algorithm>
#include <cmath>

#include "device/exact/exact_device.h"
#include "output/view.h"
#include "render/environment_image.h"
#include "render/frame_renderer.h"
#include "render/loaded_shot.h"
#include "render/render_job.h"
#include "render/stopwatch.h"
#include "shot/shot_parser.h"

namespace kadr::stress {
namespace {

constexpr double kStep = 1.0 / 255;
/// Beyond these the reference would take minutes, and rays by the million are as many as the sweep needs. Triangles that lie
/// in one place are each asked about by every ray there, 20 ms for a million; of a fan, every ray asks a part of all needles, in
/// spite of their up to 16 boxes, which take 200 bytes each while they are built.
constexpr int kLargestSide = 256;
constexpr std::size_t kMostTriangles = 50'000;

PictureFigures difference(const Image& is, const Image& wanted) {
    PictureFigures figures;
    const std::size_t pixels = is.pixels.size() / is.channels.size();
    for (std::size_t i = 0; i < pixels; ++i) {
        double worst = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const double off = std::abs(static_cast<double>(is.pixels[3 * i + c]) - wanted.pixels[3 * i + c]);
            figures.mean += off;
            worst = std::max(worst, off);
        }
        figures.largest = std::max(figures.largest, worst);
        figures.beyond += worst > kStep ? 1 : 0;
    }
    figures.mean /= 3 * static_cast<double>(pixels);
    figures.beyond /= static_cast<double>(pixels);
    return figures;
}

std::uint64_t count_not_finite(const Image& image) {
    return static_cast<std::uint64_t>(std::count_if(image.pixels.begin(), image.pixels.end(), [](float x) { return !std::isfinite(x); }));
}

bool fits_reference(const LoadedShot& loaded) {
    std::size_t triangles = 0;
    for (const GeometryData& mesh : loaded.scene().geometries) triangles += mesh.indices.size() / 3;
    const ImageSpec& image = loaded.shot().image;
    return std::max(image.width, image.height) <= kLargestSide && triangles <= kMostTriangles;
}

FrameTime only_frame(const BoundShot& shot) { return shot.sequence().frame(shot.timing().frames.front()); }

Image shown(const LoadedShot& loaded, const Image& linear) { return apply_view(linear, loaded.shot().view, false); }

Image render_exactly(const LoadedShot& loaded) {
    const std::unique_ptr<Device> reference = make_exact_device(loaded.bound());
    load_device(*reference, loaded);
    return shown(loaded, FrameRenderer(*reference).render(loaded.bound(), only_frame(loaded.bound()), {}).image);
}

RayFigures compare_parts(Device& device, const LoadedShot& loaded, const RayCounts& counts) {
    const std::unique_ptr<Device> reference = make_exact_device(loaded.bound());
    load_device(*reference, loaded);
    // One part is enough: each begins at another time, not with another kind of ray.
    const SceneSnapshot snapshot = make_snapshots(loaded.bound(), only_frame(loaded.bound())).front();
    device.set_frame(snapshot);
    reference->set_frame(snapshot);
    return compare_rays(device, *reference, snapshot, counts);
}

}  // namespace

struct Evaluator::Rendered {
    std::optional<Image> exact;
};

bool CellResult::sound() const {
    if (!refused.empty()) return refusal_expected;
    return not_finite == 0 && dropped_samples == 0 && (!picture || picture->mean < kStep) && (!rays || rays->errors() == 0);
}

Evaluator::Evaluator(EvaluateOptions options, std::filesystem::path folder) : options_(std::move(options)), folder_(std::move(folder)) {}

CellResult Evaluator::evaluate(const Cell& cell) {
    const Stopwatch watch;
    CellResult result;
    result.cell = cell;
    result.shot = write_shot(cell, folder_);
    const std::string_view expected = refusal_of(cell);
    try {
        const Rendered rendered = render(result.shot, result);
        if (rendered.exact && cell.axis->same_picture && !cell.second) {
            const Image& ordinary = ordinary_picture(*cell.axis);
            if (ordinary.pixels.size() == rendered.exact->pixels.size()) result.drift = difference(*rendered.exact, ordinary);
        }
    } catch (const InputError& error) {
        result.refused = error.diagnostics().front().found;
        // What a machine has memory for, the table cannot know.
        const bool too_large = result.refused.find("and this machine has") != std::string::npos;
        result.refusal_expected = too_large || (!expected.empty() && result.refused.find(expected) != std::string::npos);
    }
    result.seconds = watch.seconds();
    return result;
}

Evaluator::Rendered Evaluator::render(const std::filesystem::path& shot, CellResult& result) const {
    const LoadedShot loaded(parse_shot(shot));
    for (const Diagnostic& warning : loaded.warnings()) result.warnings.push_back(warning.found);
    const DeviceChoice choice = make_device(options_.device);
    load_device(*choice.device, loaded);
    const RenderedFrame frame = FrameRenderer(*choice.device).render(loaded.bound(), only_frame(loaded.bound()), {});
    result.dropped_samples = frame.statistics.dropped_samples;
    result.not_finite = count_not_finite(frame.image);
    if (!fits_reference(loaded)) return {};
    Rendered rendered{render_exactly(loaded)};
    result.picture = difference(shown(loaded, frame.image), *rendered.exact);
    if (choice.device->probe()) result.rays = compare_parts(*choice.device, loaded, options_.rays);
    return rendered;
}

const Image& Evaluator::ordinary_picture(const Axis& axis) {
    if (axis_ == &axis) return ordinary_;
    const LoadedShot loaded(parse_shot(write_shot({&axis, axis.ordinary}, folder_)));
    ordinary_ = render_exactly(loaded);
    axis_ = &axis;
    return ordinary_;
}

}  // namespace kadr::stress
