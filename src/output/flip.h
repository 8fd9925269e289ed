#pragma once

#include "film/film.h"

namespace kadr {

/// The LDR-FLIP error map: how different two images look, pixel for pixel, when a viewer flips between them.
///
/// @param reference, test    sRGB display values (channels R, G, B in [0, 1]; clamped), of the same size
/// @param pixels_per_degree  67: a 0.7 m wide 4K monitor at 0.7 m, the authors' default
/// @return one channel, "Y", of 0 (equal) to 1
/// @throws InputError  when the sizes differ
/// Source: Andersson, Nilsson, Akenine-Moeller, Oskarsson, Astrom, Fairchild, "FLIP: A Difference Evaluator for
/// Alternating Images", HPG 2020.
Image flip_map(const Image& reference, const Image& test, double pixels_per_degree = 67);

/// Mean of flip_map. @throws InputError  when the sizes differ
double mean_flip(const Image& reference, const Image& test, double pixels_per_degree = 67);

}  // namespace kadr
