#pragma once

#include "denoise/denoiser.h"
#include "film/film.h"
#include "shot/shot.h"

namespace kadr {

/// What the shot asks for; null for none. @throws InputError  at the shot's key where the library is not there
const Denoiser* denoiser_of(const RenderSpec& render);

/// The layers that the film needs: those wanted, and what guides a denoiser.
FilmLayers layers_to_render(FilmLayers wanted, const RenderSpec& render);

/// Denoises a developed film of layers_to_render, and leaves the channels of the wanted layers.
/// @throws InputError, RenderError
void denoise(Image& image, const FilmLayers& wanted, const RenderSpec& render);

}  // namespace kadr
