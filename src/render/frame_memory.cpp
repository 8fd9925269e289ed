#include "render/frame_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "base/error.h"
#include "film/film.h"
#include "output/image_io.h"
#include "render/denoising.h"
#include "render/frame_identity.h"
#include "render/frame_renderer.h"
#include "render/sample_steering.h"

namespace kadr {

namespace {

constexpr double kColor = 4 * sizeof(float), kShown = 3 * sizeof(float);

double channels_of(const FilmLayers& layers) {
    return 4 + 3 * layers.albedo + 3 * layers.normal + layers.depth + 2 * layers.motion + layers.samples + layers.error;
}

/// The picture as the library takes it, and the file in memory: beauty in halves, layers in floats. Measured at 1920 x 1080
/// and 3840 x 2160: 22 bytes a pixel without layers, 127 with ten channels of them.
double exr_bytes(double channels) { return channels * sizeof(float) + 1.25 * (4 * sizeof(std::uint16_t) + (channels - 4) * sizeof(float)); }
/// Three values and the file; measured at 3840 x 2160: 4.3 bytes a pixel of eight bits.
double png_bytes(int bits) { return bits == 16 ? 9 : 4.3; }

/// Of a pixel, where the noise of `rows` rows of `height` is looked at at once: two pictures, one half, and the noise.
double estimating_bytes(int rows, int height) { return std::min(1.0, static_cast<double>(rows) / height) * (2 * kShown + kColor + sizeof(double)); }

}  // namespace

int film_halves(const RenderSpec& render, std::size_t parts) { return render.samples > 1 || parts > 1 ? Film::kHalves : 1; }

double FrameBytes::finishing() const {
    if (film_is_kept) return sums + std::max(estimating, image + writing);
    return std::max(sums + estimating, image + writing);
}

FrameBytes frame_bytes(const Shot& shot, std::size_t parts, bool weighted) {
    const FilmLayers layers = layers_to_render(film_layers(shot.output.aovs), shot.render);
    const double pixels = static_cast<double>(shot.image.width) * shot.image.height, channels = channels_of(layers);
    FrameBytes bytes;
    const int halves = film_halves(shot.render, parts);
    bytes.sums = pixels * static_cast<double>(Film::bytes_per_pixel(layers, halves, weighted));
    bytes.film_is_kept = bytes.sums <= static_cast<double>(kMostFilmKept);
    bytes.image = pixels * channels * sizeof(float);
    if (halves > 1) bytes.estimating = pixels * estimating_bytes(kNoiseRows, shot.image.height);
    for (const std::string& pattern : shot.output.frames)
        bytes.writing = std::max(bytes.writing, pixels * (is_linear_file(pattern) ? exr_bytes(channels) : kShown + png_bytes(shot.output.png_bits)));
    if (shot.output.video) bytes.encoding = pixels * (kShown + kShown);
    return bytes;
}

std::uint64_t machine_memory_bytes() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    const std::uint64_t machine = pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
    std::uint64_t granted = 0;
    std::ifstream("/sys/fs/cgroup/memory.max") >> granted;  // "max" where there is no limit
    return granted > 0 && (machine == 0 || granted < machine) ? granted : machine;
}

void check_frame_memory(const Shot& shot) {
    const double wanted = frame_bytes(shot, 1, false).finishing(), there = static_cast<double>(machine_memory_bytes());
    if (there == 0 || wanted <= there) return;
    constexpr double kGigabyte = 1e9;
    Diagnostic problem;
    problem.where.file = shot.file.string();
    problem.found = fmt::format("image.size is [{}, {}]: a frame takes about {:.1f} GB of memory, and this machine has {:.1f}", shot.image.width, shot.image.height,
                                wanted / kGigabyte, there / kGigabyte);
    problem.expected = shot.output.aovs.empty() ? "expected a smaller picture" : "expected a smaller picture, or fewer output.aovs";
    throw InputError(std::move(problem));
}

}  // namespace kadr
