#include "cli/explain_text.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace kadr {
namespace {

using Json = nlohmann::ordered_json;

std::string size_line(const Explanation& e) {
    return fmt::format("{}: {} frame{} from {} to {}, {} x {} pixels, {} sample{} a pixel\n", e.shot, e.frames, e.frames == 1 ? "" : "s", e.first_frame, e.last_frame, e.width,
                       e.height, e.samples, e.samples == 1 ? "" : "s");
}

/// "material 'Visor' and 3 more materials".
std::string reason(const Requirement& requirement, const FeatureInfo& info) {
    if (requirement.count == 1) return requirement.first;
    return fmt::format("{}, one of {} {}", requirement.first, requirement.count, info.askers);
}

std::string needs_text(const RequirementSet& needs) {
    std::string text = "needs\n";
    std::string group;
    for (const Requirement& requirement : needs.entries) {
        const FeatureInfo& info = info_of(requirement.feature);
        text += fmt::format("  {:<12}  {:<36}  {}\n", info.group == group ? "" : info.group, info.name, reason(requirement, info));
        group = info.group;
    }
    return text;
}

/// Things of one kind that are left out for one reason.
struct Group {
    std::string kind, why, first;
    std::size_t count = 0;
};

std::vector<Group> grouped(const std::vector<Unread>& all) {
    std::vector<Group> groups;
    for (const Unread& one : all) {
        auto group = std::find_if(groups.begin(), groups.end(), [&](const Group& known) { return known.kind == one.kind && known.why == one.why; });
        if (group == groups.end()) group = groups.insert(groups.end(), {one.kind, one.why, one.name, 0});
        ++group->count;
    }
    return groups;
}

std::string left_out_text(const std::vector<Unread>& left_out) {
    if (left_out.empty()) return "leaves out\n  nothing: all that the files hold is used\n";
    std::string text = "leaves out (neither read nor in memory)\n";
    for (const Group& group : grouped(left_out)) {
        const std::string names = group.count == 1 ? group.first : fmt::format("{} and {} more", group.first, group.count - 1);
        text += fmt::format("  {:<12}  {:<36}  {}\n", group.kind, names, group.why);
    }
    return text;
}

std::string extensions_text(const std::vector<FileExtensions>& files) {
    std::string text;
    for (const FileExtensions& file : files) {
        if (!file.followed.empty()) text += fmt::format("  {:<12}  follows {}\n", file.scene, fmt::join(file.followed, ", "));
        if (!file.ignored.empty()) text += fmt::format("  {:<12}  ignores {}\n", file.followed.empty() ? file.scene : "", fmt::join(file.ignored, ", "));
    }
    return "glTF extensions\n" + (text.empty() ? "  none\n" : text);
}

std::string kernels_text(const Explanation& e) {
    std::string text = fmt::format("kernels\n  {}: {}\n", e.device, e.device_why);
    for (const KernelUse& use : e.kernels) text += fmt::format("  {}: frame{} {}\n", use.name == "nothing" ? e.integrator + ", plain" : e.integrator + " with " + use.name, use.frames.size() == 1 ? "" : "s", fmt::join(use.frames, ", "));
    return text + fmt::format("  robust rays: {}\n", e.robust);
}

double mebibytes(double bytes) { return bytes / 1048576; }

std::string memory_text(const MemoryForecast& memory) {
    std::string text = fmt::format("memory on the CPU: about {:.0f} MiB at the most, when {}\n", mebibytes(memory.total()), memory.moment);
    for (const MemoryPart& part : memory.parts) text += fmt::format("  {:<12}  {:>10.1f} MiB  {}\n", part.name, mebibytes(part.bytes), part.of);
    return text;
}

std::string cost_text(const Explanation& e) {
    std::string text = fmt::format("cost of a frame: at most {:.4g} million samples\n", 1e-6 * static_cast<double>(e.pixel_samples));
    if (!e.cost) return text + "  its time was not measured: kadr explain --measure renders a little\n";
    const FrameCost& cost = *e.cost;
    return text + fmt::format("  at most {:.3g} s to trace, and {:.3g} s to set up the first: by frame {} at {} x {} with {} samples a pixel, {:.3g} million samples a second of {:.1f} rays each\n",
                              cost.trace_s, cost.load_s, cost.frame, cost.width, cost.height, cost.samples, 1e-6 * cost.pixel_samples_per_s, cost.rays_per_sample);
}

Json json_of_cost(const Explanation& e) {
    Json json{{"pixel_samples", e.pixel_samples}};
    if (e.cost)
        json["measured"] = {{"frame", e.cost->frame}, {"width", e.cost->width}, {"height", e.cost->height}, {"samples", e.cost->samples}, {"load_s", e.cost->load_s},
                            {"pixel_samples_per_s", e.cost->pixel_samples_per_s}, {"rays_per_sample", e.cost->rays_per_sample}, {"trace_s", e.cost->trace_s}};
    return json;
}

Json json_of(const MemoryForecast& memory) {
    Json parts = Json::array();
    for (const MemoryPart& part : memory.parts) parts.push_back({{"name", part.name}, {"bytes", static_cast<std::uint64_t>(part.bytes)}, {"of", part.of}});
    return {{"bytes", static_cast<std::uint64_t>(memory.total())}, {"when", memory.moment}, {"parts", parts}};
}

Json json_of(const std::vector<KernelUse>& kernels) {
    Json list = Json::array();
    for (const KernelUse& use : kernels) list.push_back({{"name", use.name}, {"frames", use.frames}});
    return list;
}

Json json_of(const RequirementSet& needs) {
    Json list = Json::array();
    for (const Requirement& requirement : needs.entries) {
        const FeatureInfo& info = info_of(requirement.feature);
        list.push_back({{"group", info.group}, {"name", info.name}, {"first", requirement.first}, {"count", requirement.count}, {"askers", info.askers}});
    }
    return list;
}

Json json_of(const std::vector<Unread>& left_out) {
    Json list = Json::array();
    for (const Unread& one : left_out) list.push_back({{"kind", one.kind}, {"name", one.name}, {"why", one.why}});
    return list;
}

Json json_of(const std::vector<FileExtensions>& files) {
    Json list = Json::array();
    for (const FileExtensions& file : files) list.push_back({{"scene", file.scene}, {"followed", file.followed}, {"ignored", file.ignored}});
    return list;
}

}  // namespace

std::string explanation_text(const Explanation& e) {
    return size_line(e) + needs_text(e.needs) + left_out_text(e.left_out) + extensions_text(e.extensions) + kernels_text(e) + memory_text(e.memory) + cost_text(e);
}

Json explanation_json(const Explanation& e) {
    std::vector<std::string> warnings;
    for (const Diagnostic& warning : e.warnings) warnings.push_back(warning.text());
    return {{"shot", e.shot},
            {"frames", {{"count", e.frames}, {"first", e.first_frame}, {"last", e.last_frame}}},
            {"image", {{"width", e.width}, {"height", e.height}, {"samples", e.samples}}},
            {"needs", json_of(e.needs)},
            {"left_out", json_of(e.left_out)},
            {"extensions", json_of(e.extensions)},
            {"device", {{"name", e.device}, {"why", e.device_why}}},
            {"integrator", e.integrator},
            {"kernels", json_of(e.kernels)},
            {"robust", e.robust},
            {"memory", json_of(e.memory)},
            {"cost", json_of_cost(e)},
            {"warnings", warnings}};
}

}  // namespace kadr
