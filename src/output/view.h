#pragma once

#include "film/film.h"
#include "shot/shot.h"

namespace kadr {

/// Applies exposure and a view transform to the beauty channels: linear Rec.709 radiance to display-referred sRGB in
/// [0, 1] (`none`: exposure only, clamped, linear). Alpha stays coverage; colour stays premultiplied for `none` and is
/// display-encoded from un-premultiplied colour, then premultiplied again, otherwise. Keeps only R, G, B (and A when
/// `keep_alpha`). NaN becomes black. `view.automatic` is the caller's to resolve (metered_exposure).
Image apply_view(const Image& linear, const ViewSpec& view, bool keep_alpha);

/// Exposure in stops that maps the log-average luminance of the lit pixels (black ones carry no logarithm) to 0.18; 0 when
/// nothing is lit.
double metered_exposure(const Image& linear);

}  // namespace kadr
