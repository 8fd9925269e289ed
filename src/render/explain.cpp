#include "render/explain.h"

#include <algorithm>
#include <thread>
#include <utility>

#include "device/embree/frame_facts.h"
#include "device/requirement_names.h"
#include "output/image_io.h"
#include "render/loaded_shot.h"
#include "render/render_job.h"

namespace kadr {
namespace {

/// The first, the middle and the last frame.
std::vector<int> telling_frames(const std::vector<int>& all) {
    std::vector<int> frames{all.front(), all[(all.size() - 1) / 2], all.back()};
    frames.erase(std::unique(frames.begin(), frames.end()), frames.end());
    return frames;
}

void add_kernels(const LoadedShot& loaded, const std::vector<SceneSnapshot>& parts, int frame, std::vector<KernelUse>& uses) {
    for (const SceneSnapshot& part : parts) {
        const std::string name = names_of_requirements(kernel_requirements_of(loaded.scene(), part));
        auto use = std::find_if(uses.begin(), uses.end(), [&](const KernelUse& known) { return known.name == name; });
        if (use == uses.end()) use = uses.insert(uses.end(), {name, {}});
        if (use->frames.empty() || use->frames.back() != frame) use->frames.push_back(frame);
    }
}

std::string robust_text(const LoadedShot& loaded, const Device& device) {
    const std::optional<bool> asked = loaded.shot().render.robust;
    if (asked) return *asked ? "yes, as the shot says" : "no, as the shot says";
    const std::optional<Slipping> slipping = loaded.slipping();
    if (slipping && !device.has_robust_rays()) return "no, as this device has none: " + slipping->text();
    return slipping ? "yes: " + slipping->text() : "no: few would slip between triangles";
}

}  // namespace

Explanation explain_shot(const ExplainOptions& options) {
    const DeviceChoice choice = make_device(options.device);
    image_io();
    RenderExtent extent;
    extent.program_bytes = static_cast<double>(current_memory_bytes());
    extent.threads = options.device.threads > 0 ? options.device.threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    LoadOptions reading;
    reading.decode_textures = options.measure;
    const LoadedShot loaded(parse_shot(options.shot, options.overrides), reading);
    const Shot& shot = loaded.shot();
    const std::vector<int>& frames = loaded.bound().timing().frames;
    Explanation explanation;
    explanation.shot = shot.name;
    explanation.frames = static_cast<int>(frames.size());
    explanation.first_frame = frames.front(), explanation.last_frame = frames.back();
    explanation.width = shot.image.width, explanation.height = shot.image.height;
    explanation.samples = shot.render.samples;
    explanation.pixel_samples = static_cast<std::uint64_t>(shot.image.width) * static_cast<std::uint64_t>(shot.image.height) * static_cast<std::uint64_t>(shot.render.samples);
    explanation.device = choice.device->name(), explanation.device_why = choice.why;
    explanation.integrator = shot.render.integrator == Integrator::path ? "path" : "direct";
    explanation.robust = robust_text(loaded, *choice.device);
    explanation.needs = requirements_of(loaded.bound());
    explanation.left_out = loaded.left_out();
    for (const SceneFile& file : loaded.scene().files) explanation.extensions.push_back({file.id, file.extensions, file.ignored_extensions});
    extent.frames = explanation.frames;
    for (const int frame : telling_frames(frames)) {
        const std::vector<SceneSnapshot> parts = make_snapshots(loaded.bound(), loaded.bound().sequence().frame(frame));
        add_kernels(loaded, parts, frame, explanation.kernels);
        MemoryForecast memory = forecast_memory(loaded, parts, extent);
        if (memory.total() > explanation.memory.total()) explanation.memory = std::move(memory);
    }
    if (options.measure) explanation.cost = measure_frame_cost(loaded, *choice.device, frames[(frames.size() - 1) / 2]);
    explanation.warnings = loaded.warnings();
    return explanation;
}

}  // namespace kadr
