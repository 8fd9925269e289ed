#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "film/film.h"
#include "shot/shot.h"

namespace kadr {

/// What an image says about itself; written as string attributes "kadr:KEY".
using Metadata = std::map<std::string, std::string>;

using Bytes = std::vector<unsigned char>;

/// How far the values of two images are apart, over all their pixels and channels.
struct ValueDifference {
    double mean = 0;               ///< of the absolute differences
    double rms = 0;                ///< root of the mean square difference
    double psnr_db = 0;            ///< 20 log10(largest value of either image, at least 1, over rms); infinite where equal
    double largest = 0;            ///< absolute difference
    int x = 0, y = 0, channel = 0; ///< where the largest is
};

/// Columns, rows and channels of an image file.
struct ImageExtent {
    int width = 0, height = 0, channels = 0;
};

/// The image library behind an interface: OpenImageIO lives in a module of its own that is opened in the background
/// (linking it the plain way costs 0.3 s at every start).
class ImageIo {
public:
    virtual ~ImageIo() = default;

    /// The content of an image file.
    ///
    /// @param format    "exr", "png", "jpg" or "jpeg"
    /// @param image     linear for EXR (beauty R, G, B, A becomes half, values beyond ±65504 are clamped; named layers
    ///                  stay float); display-referred in [0, 1] with premultiplied alpha for PNG and JPEG
    /// @param bits      8 or 16, of PNG; the others ignore it
    /// @throws RenderError  when the library refuses; the message says why
    virtual Bytes encode(const std::string& format, const Image& image, int bits, const Metadata& metadata) const = 0;

    /// Writes the encoded image to exactly `path`, synced; the caller renames. @throws RenderError
    void write(const std::filesystem::path& path, const std::string& format, const Image& image, int bits,
               const Metadata& metadata) const;

    /// Values as stored (sRGB-encoded for PNG and JPEG), alpha premultiplied; beauty channels first.
    /// @throws InputError  when there is no such file, it is not an image, or it is incomplete
    virtual Image read(const std::filesystem::path& path) const = 0;

    /// From the file's header. @throws InputError  when there is no such file or it is not an image
    virtual ImageExtent extent(const std::filesystem::path& path) const = 0;

    /// Empty for an image that Kadr did not write. @throws InputError  when there is no such file or it is not an image
    virtual Metadata read_metadata(const std::filesystem::path& path) const = 0;

    /// Whether the file is an image with nothing missing at its end; cheap (nothing is decoded but the last rows of an EXR).
    virtual bool is_complete(const std::filesystem::path& path) const = 0;

    /// What the library's own comparison says (the figures that its `idiff` prints).
    /// @param a, b  finite values, of one size and with the same number of channels
    /// @throws RenderError  when the library refuses
    virtual ValueDifference compare(const Image& a, const Image& b) const = 0;

    /// The first channel of an image as colours: 0 is black, 1 the brightest of the map "magma" (perceptually even).
    /// @return display-referred R, G, B  @throws RenderError  when the library refuses
    virtual Image heat_map(const Image& values) const = 0;
};

/// Starts opening the module on another thread; cheap to call again.
void open_image_io_in_background();
/// The module, opened now if it is not yet. Looked for as KADR_IMAGE_MODULE, then as lib/kadr/kadr_image.so in the folders
/// above the executable's. @throws RenderError naming the file that is missing
const ImageIo& image_io();

}  // namespace kadr
