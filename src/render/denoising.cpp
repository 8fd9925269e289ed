#include "render/denoising.h"

#include <string_view>

#include "base/error.h"

namespace kadr {

namespace {

/// Drops the channels of a layer ("albedo.R", ...).
void drop_layer(Image& image, std::string_view layer) {
    std::vector<std::size_t> kept;
    for (std::size_t c = 0; c < image.channels.size(); ++c)
        if (!image.channels[c].starts_with(layer)) kept.push_back(c);
    const std::size_t count = image.channels.size();
    std::size_t out = 0;
    // In place: a kept value never moves to the right.
    for (std::size_t pixel = 0; pixel < image.pixels.size(); pixel += count)
        for (const std::size_t c : kept) image.pixels[out++] = image.pixels[pixel + c];
    image.pixels.resize(out);
    std::vector<std::string> names;
    for (const std::size_t c : kept) names.push_back(image.channels[c]);
    image.channels = std::move(names);
}

}  // namespace

const Denoiser* denoiser_of(const RenderSpec& render) {
    if (render.denoise == DenoiserKind::none) return nullptr;
    try {
        return &oidn_denoiser();
    } catch (const InputError& error) {
        Diagnostic problem = error.diagnostics().front();
        if (problem.where.file.empty()) problem.where = render.denoise_where;
        throw InputError(problem);
    }
}

FilmLayers layers_to_render(FilmLayers wanted, const RenderSpec& render) {
    if (render.denoise != DenoiserKind::none) wanted.albedo = wanted.normal = true;
    return wanted;
}

void denoise(Image& image, const FilmLayers& wanted, const RenderSpec& render) {
    const Denoiser* denoiser = denoiser_of(render);
    if (!denoiser) return;
    denoiser->apply(image);
    if (!wanted.albedo) drop_layer(image, "albedo.");
    if (!wanted.normal) drop_layer(image, "normal.");
}

}  // namespace kadr
