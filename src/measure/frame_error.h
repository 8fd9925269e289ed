#pragma once

#include <optional>

#include "measure/frame_difference.h"

namespace kadr {

/// Two images of one frame, made with different seeds and otherwise alike: independent draws around the same mean.
struct Replicates {
    StoredImage a, b;
};

/// How far renders of a frame are from the truth, and why. All but FLIP and SSIM are relative mean squares: divided by
/// reference² + 0.01, as relative_mse is.
struct FrameError {
    double relmse = 0;  ///< of one image, against the reference, less the reference's own noise
    double noise = 0;   ///< what other samples would change: half the mean square of a - b
    /// What more samples would not change: the mean of (a - r1) (b - r2), whose four images are independent of each other,
    /// so their noise averages out and does not count as bias. May be a little below zero.
    double bias = 0;
    double flip = 0, ssim = 1;  ///< mean of both images, against the reference
};

/// @param reference  r1 and r2; their mean is the reference
/// @throws InputError  when sizes differ
FrameError error_of(const Replicates& reference, const Replicates& test, const DifferenceOptions& options);

/// The reference's noise that is left in the mean of its two images.
double noise_of_mean(const Replicates& reference);

/// The mean of two images of the same size and channels.
StoredImage mean_of(const Replicates& images);

/// How much more, or less, the picture changes from one frame to the next than the truth does: the mean absolute difference
/// of the changes of display values. 0: as steady as the truth.
double flicker(const StoredImage& reference, const StoredImage& next_reference, const StoredImage& test,
               const StoredImage& next_test, const ViewSpec& view);

}  // namespace kadr
