#pragma once

#include <memory>
#include <string>

#include "film/film.h"

namespace kadr {

/// Open Image Denoise on the CPU, behind an interface: the library is opened when a shot asks for it, and a machine
/// without it renders all other shots.
class Denoiser {
public:
    virtual ~Denoiser() = default;
    virtual std::string version() const = 0;  ///< "2.5.1"

    /// Replaces R, G and B (linear radiance, premultiplied) by their denoised values. The channels albedo.R/G/B and
    /// normal.X/Y/Z guide it where the image has them; they and alpha stay as they are.
    /// @throws RenderError  when the library refuses; the message says why
    virtual void apply(Image& image) const = 0;
};

/// The library's denoiser, opened by the first call that finds it: KADR_OIDN_LIBRARY, else libOpenImageDenoise.so.2 where
/// the system's loader looks, else in Kadr's cache folder and in the Python packages of this machine (pip install pyoidn).
/// @throws InputError  where none is found or opens; with the reason of the last one that was tried
const Denoiser& oidn_denoiser();

/// The same over one library file, not kept. @throws InputError
std::unique_ptr<const Denoiser> open_oidn(const std::string& file);

}  // namespace kadr
