#include <utility>

#include <fmt/format.h>

#include "frame/problem.h"
#include "output/encoder.h"
#include "output/image_io.h"
#include "render/clip_report.h"
#include "render/denoising.h"
#include "render/frame_memory.h"
#include "render/loaded_shot.h"
#include "render/output_plan.h"
#include "render/render_job.h"
#include "render/timeline.h"

namespace kadr {
namespace {

/// What the shot says alone, or with its scenes where they could be loaded.
struct Bound {
    std::vector<int> frames;
    CheckReport report;
};

/// What `kadr check --verbose` prints of a shot that binds.
std::string details_of(const LoadedShot& loaded) { return timeline_text(loaded.bound()) + clip_report(loaded.bound()); }

Bound bind_names(const Shot& shot, bool verbose, std::vector<Diagnostic>& problems) {
    Bound bound{shot.timing.frames, {shot.warnings, {}}};
    collect(problems, [&] {
        LoadOptions options;
        options.decode_textures = false;
        const LoadedShot loaded(shot, options, Reading::everything);
        bound = {loaded.bound().timing().frames, {loaded.warnings(), verbose ? details_of(loaded) : std::string()}};
    });
    return bound;
}

void check_folders(const Shot& shot, const std::vector<int>& frames, std::vector<Diagnostic>& problems) {
    for (const std::filesystem::path& folder : output_folders(shot.output, frames)) {
        const std::string reason = why_not_writable(folder);
        if (reason.empty()) continue;
        Diagnostic problem;
        problem.where.file = shot.file.string();
        problem.found = fmt::format("cannot write to the folder {}", folder.string());
        problem.expected = reason;
        problems.push_back(std::move(problem));
    }
}

}  // namespace

CheckReport check_shot(const std::filesystem::path& path, const ShotOverrides& overrides, bool verbose) {
    const Shot shot = parse_shot(path, overrides);
    std::vector<Diagnostic> problems;
    Bound bound = bind_names(shot, verbose, problems);
    if (shot.output.video)
        collect(problems, [&] {
            plan_video(*shot.output.video, shot.image.width, shot.image.height, shot.timing.fps);
        });
    collect(problems, [&] { denoiser_of(shot.render); });
    collect(problems, [&] { check_frame_memory(shot); });
    if (shot.environment.image) collect(problems, [&] { image_io().read_metadata(*shot.environment.image); });
    for (Diagnostic& problem : colliding_patterns(shot.output, bound.frames)) problems.push_back(std::move(problem));
    check_folders(shot, bound.frames, problems);
    if (!problems.empty()) throw InputError(std::move(problems));
    return std::move(bound.report);
}

}  // namespace kadr
