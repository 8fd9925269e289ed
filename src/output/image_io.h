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

/// The image library behind an interface: OpenImageIO lives in a module of its own that is opened in the background
/// (linking it the plain way costs 0.3 s at every start).
class ImageIo {
public:
    virtual ~ImageIo() = default;
    /// Writes exactly to `path` (the caller renames); half for beauty channels and float for layers in EXR, 8 or 16
    /// bits for PNG, 8 for JPEG. Channels of `image` are already display-referred for PNG and JPEG.
    /// @throws RenderError
    virtual void write(const std::filesystem::path& path, const std::string& format, const Image& image, int bits,
                       const Metadata& metadata) const = 0;
    /// @throws InputError when it is not an image
    virtual Image read(const std::filesystem::path& path) const = 0;
    virtual Metadata read_metadata(const std::filesystem::path& path) const = 0;
};

/// Starts opening the module on another thread; cheap to call again.
void open_image_io_in_background();
/// The module, opened now if it is not yet. @throws RenderError naming the file that is missing
const ImageIo& image_io();

}  // namespace kadr
