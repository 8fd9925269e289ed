#pragma once

#include <cstddef>
#include <string>

#include "output/image_io.h"
#include "shot/shot.h"

namespace kadr {

/// An image as it was read: linear radiance (EXR) or display values (PNG, JPEG).
struct StoredImage {
    Image image;
    bool linear = false;
};

/// Reads R, G, B and, where there is one, A; grey is repeated. Other layers are left out.
/// @throws InputError  no such file, not an image, or one without colours
StoredImage read_stored(const std::filesystem::path& file);

struct DifferenceOptions {
    ViewSpec view;                  ///< how linear images are looked at
    double pixels_per_degree = 67;  ///< of FLIP
};

/// How far one image is from another.
struct FrameDifference {
    ValueDifference values;       ///< as stored: linear radiance where both images are, else display values
    std::string largest_channel;  ///< of values.largest
    double relmse = 0;            ///< of linear radiance (display values are decoded)
    double ssim = 1;              ///< of display values
    double flip = 0;              ///< mean LDR-FLIP of display values
    std::size_t not_finite = 0;   ///< pixels that hold NaN or infinity on either side; black in all of the above
};

/// A difference with the pictures that show it: display-referred R, G, B over black.
struct ShownDifference {
    FrameDifference difference;
    Image reference, test, flip;  ///< `flip` has one channel, "Y"
};

/// Alpha counts where both images have it.
/// @throws InputError  when the sizes differ; the message names the files
ShownDifference difference_between(const StoredImage& reference, const StoredImage& test,
                                   const DifferenceOptions& options);

}  // namespace kadr
