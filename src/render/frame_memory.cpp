#include "render/frame_memory.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

#include <fmt/format.h>

#include "base/error.h"
#include "film/film.h"
#include "render/denoising.h"
#include "render/frame_renderer.h"

namespace kadr {

namespace {

std::uint64_t channels_of(const FilmLayers& layers) {
    return 4 + (layers.albedo ? 3u : 0u) + (layers.normal ? 3u : 0u) + (layers.depth ? 1u : 0u) + (layers.motion ? 2u : 0u) + (layers.samples ? 1u : 0u) + (layers.error ? 1u : 0u);
}

}  // namespace

std::uint64_t frame_bytes(const Shot& shot) {
    const FilmLayers layers = layers_to_render(film_layers(shot.output.aovs), shot.render);
    const std::uint64_t film = Film::kHalves * (sizeof(Film::Beauty) + sizeof(std::uint32_t)) + (layers.any_surface() ? sizeof(Film::Surface) : 0);
    // The developed image, and a copy of it seen through the view or on its way into a file.
    const std::uint64_t images = 2 * channels_of(layers) * sizeof(float);
    return static_cast<std::uint64_t>(shot.image.width) * static_cast<std::uint64_t>(shot.image.height) * (film + images);
}

std::uint64_t machine_memory_bytes() {
    const long pages = ::sysconf(_SC_PHYS_PAGES), page = ::sysconf(_SC_PAGESIZE);
    const std::uint64_t machine = pages > 0 && page > 0 ? static_cast<std::uint64_t>(pages) * static_cast<std::uint64_t>(page) : 0;
    std::uint64_t granted = 0;
    std::ifstream("/sys/fs/cgroup/memory.max") >> granted;  // "max" where there is no limit
    return granted > 0 && (machine == 0 || granted < machine) ? granted : machine;
}

void check_frame_memory(const Shot& shot) {
    const std::uint64_t wanted = frame_bytes(shot), there = machine_memory_bytes();
    if (there == 0 || wanted <= there) return;
    constexpr double kGigabyte = 1e9;
    Diagnostic problem;
    problem.where.file = shot.file.string();
    problem.found = fmt::format("image.size is [{}, {}]: a frame takes about {:.1f} GB of memory, and this machine has {:.1f}", shot.image.width, shot.image.height,
                                static_cast<double>(wanted) / kGigabyte, static_cast<double>(there) / kGigabyte);
    problem.expected = shot.output.aovs.empty() ? "expected a smaller picture" : "expected a smaller picture, or fewer output.aovs";
    throw InputError(std::move(problem));
}

}  // namespace kadr
