#include "cli/device_comparison_text.h"

#include <array>

#include <fmt/format.h>

namespace kadr {
namespace {

std::string seen_text(const SeenSurface& seen) {
    if (!seen.met) return "nothing";
    return fmt::format("{} (mesh {}, triangle {}) at {:.6g} m", seen.node,
                       seen.mesh.empty() ? "without a name" : seen.mesh, seen.primitive, seen.distance_m);
}

std::string rays_text(const RayAgreement& r, const DeviceComparisonOptions& options) {
    std::string text = fmt::format(
        "  rays     {} {}: {} of {} camera rays contradict; {} more met another triangle at an edge, {} one in the "
        "same place (error bar {:.2g} px)\n",
        r.wrong() == 0 ? "ok    " : "DIFFER",
        r.wrong_ids > 0 && r.wrong_places > 0 ? "ids and places"
        : r.wrong_places > 0                  ? "places"
                                              : "ids",
        r.wrong(), r.rays, r.at_edges, r.same_place, r.error_bar_px);
    if (const auto& bad = r.first_bad)
        text += fmt::format("           first bad pixel {},{} of frame {} at {:g} of the shutter: {} sees {}, {} {}\n",
                            bad->x, bad->y, bad->frame, bad->time, options.devices.first, seen_text(bad->first),
                            options.devices.second, seen_text(bad->second));
    return text;
}

std::string scale_text(const ScaleResult& s) {
    static constexpr std::array<const char*, 3> kChannels{"R", "G", "B"};
    std::string shares;
    for (std::size_t k = 0; k < s.beyond.size(); ++k)
        shares += fmt::format(" {:.3f}% ({:.3f}%)", 100 * s.beyond[k], 100 * kNormalBeyond[k]);
    return fmt::format("  {:<8} {} {} tests; |z| > 2, 3, 4:{}; largest z {:+.2f} at {},{} in {}; {} rejected\n", s.name,
                       s.rejected == 0 ? "ok    " : "DIFFER", s.tests, shares, s.largest_z, s.x, s.y,
                       kChannels[static_cast<std::size_t>(s.channel)], s.rejected);
}

std::string times_text(const DeviceTimes& t, const std::string& name) {
    return fmt::format("  {:<8} load {:.3f} s, set_frame {:.3f} s, render {:.3f} s, {:.2f} million rays/s\n", name,
                       t.load_s, t.set_frame_s, t.render_s, t.rays_per_s() * 1e-6);
}

}  // namespace

std::string comparison_text(const ComparedDeviceFrame& frame, const DeviceComparisonOptions& options) {
    std::string text = fmt::format("frame {}\n", frame.frame) + rays_text(frame.rays, options);
    for (const ScaleResult& scale : frame.noise.scales) text += scale_text(scale);
    const ZTest& z = frame.noise;
    text += fmt::format("  mean     {} {:+.4f}% of {}, 95% interval {:+.4f}% to {:+.4f}%\n", options.devices.second,
                        100 * z.difference, options.devices.first, 100 * z.difference_from, 100 * z.difference_to);
    text += fmt::format("  pictures FLIP {:.5f}, relMSE {:.3g}; noise alone {:.5f}, {:.3g}\n", frame.pictures.flip,
                        frame.pictures.relmse, frame.noise_alone.flip, frame.noise_alone.relmse);
    text += times_text(frame.times[0], options.devices.first) + times_text(frame.times[1], options.devices.second);
    for (const int i : {0, 1})
        if (frame.dropped[i] > 0)
            text += fmt::format("  {} samples of {} were dropped\n", frame.dropped[i],
                                i == 0 ? options.devices.first : options.devices.second);
    return text;
}

}  // namespace kadr
