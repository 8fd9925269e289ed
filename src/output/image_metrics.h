#pragma once

#include "film/film.h"

namespace kadr {

/// Relative mean square error of radiance: the mean over pixels and R, G, B of (test - reference)² / (reference² +
/// 0.01). Bright and dark places weigh alike; the constant keeps black ones from deciding alone.
///
/// @param reference, test  linear radiance, finite, of the same size, with channels R, G, B
/// Source: Rousselle, Knaus, Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", SIGGRAPH
/// Asia 2011, section 5.
double relative_mse(const Image& reference, const Image& test);

/// Mean structural similarity of the lumas: 1 where equal, 0 where nothing is alike, negative where inverted. Windows
/// are Gaussians of 11 x 11 pixels (deviation 1.5) that lie in the image as a whole; an image smaller than that shrinks
/// them.
///
/// @param reference, test  display values in [0, 1], of the same size, with channels R, G, B
/// Source: Wang, Bovik, Sheikh, Simoncelli, "Image Quality Assessment: From Error Visibility to Structural Similarity",
/// IEEE Transactions on Image Processing 13(4), 2004; K1 = 0.01, K2 = 0.03.
double structural_similarity(const Image& reference, const Image& test);

}  // namespace kadr
