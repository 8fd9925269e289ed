// What a GPU kernel gets at a launch: plain data, passed by value as the kernel's one argument. Pointers are device
// addresses. The host and the GPU's run-time compiler read this same file, and the assertions below hold for both.
#pragma once

#include "kernels/camera/filter.h"
#include "kernels/camera/shutter.h"
#include "kernels/scene/scene_view.h"

namespace kadr::kernels {

/// Threads of a block: one a pixel. Compact, so that the rays of a block stay together.
inline constexpr int kBlockWidth = 8, kBlockHeight = 8;

/// A pixel's sums over the samples of one half of the film.
struct FilmBeauty {
    double r, g, b, alpha;
};

/// A pixel's sums of a data layer: of colours and directions, and of what moves in the picture.
struct FilmVector {
    double x, y, z;
};
struct FilmMotion {
    double x, y;
};

/// The film as it lies on the device, [y][x] of the whole image: one half's sums, and the layers, which the halves
/// share. Null: not wanted.
struct FilmView {
    FilmBeauty* beauty;
    unsigned* samples;  ///< kept samples of the half
    double* weights;    ///< sums of the samples' shares of the light; null: the film is not weighted
    FilmVector *albedo, *normal;
    double* depth;       ///< over the samples that met a surface
    double* hits;        ///< their weight; wanted with depth and with motion
    FilmMotion* motion;  ///< over the samples that met a surface
};

/// Sums over all launches since the host cleared them.
struct LaunchCounters {
    unsigned long long rays;             ///< camera, bounce and shadow rays
    unsigned long long samples;          ///< that went into the film
    unsigned long long dropped;          ///< samples whose value was not finite, or whose ray could not be traced
    unsigned long long stack_overflows;  ///< rays that needed a deeper traversal stack than there is
};

/// One launch: samples [first_sample, first_sample + sample_count) of one half, of the pixels in [x0, x1) x [y0, y1).
/// Launches of a half must come in the order of their samples: sums are in that order.
template <class T>
struct LaunchParamsOf {
    SceneViewOf<T> scene;
    const void* top;              ///< hiprtScene; null: nothing to meet
    const void* functions;        ///< hiprtFuncTable of the geometry types below; null: no geometry has a type
    const unsigned* instance_of;  ///< [instance of `top`] index into SceneView::instances
    const FilterTable* filter;
    const Shutter* shutter;
    const unsigned char* active;  ///< [y][x] of the image, 0: the pixel has samples enough; null: all are active
    FilmView film;
    LaunchCounters* counters;
    unsigned seed;      ///< seed_of_half(scene.settings.seed, half)
    unsigned ray_mask;  ///< meets instances whose mask shares a bit; ~0u: all of `top`
    int x0, y0, x1, y1;
    int first_sample, sample_count;
    bool centred;  ///< one sample in all: the pixel's centre, a pinhole, the shutter's opening
};
using LaunchParams = LaunchParamsOf<float>;

/// hiprtGeometryBuildInput::geomType, the row of the function table that rays ask about a hit. What every ray stops at
/// is of no type (hiprtInvalidValue).
namespace geometry_type {
inline constexpr unsigned kFiltered = 0;  ///< triangles that let some rays pass: partial coverage, culled faces
inline constexpr unsigned kMoving = 1;    ///< boxes around triangles whose corners move while the shutter is open
inline constexpr unsigned kCount = 2;
}  // namespace geometry_type

static_assert(sizeof(void*) == 8 && sizeof(long) == 8 && sizeof(bool) == 1, "the widths that host and device share");
static_assert(sizeof(FilmBeauty) == 32 && sizeof(FilmVector) == 24 && sizeof(FilmMotion) == 16 && sizeof(FilmView) == 64,
              "copied to the host's film");
static_assert(sizeof(LaunchCounters) == 32, "read back by the host");
static_assert(sizeof(Material) == 216 && sizeof(Texture) == 24 && sizeof(Geometry) == 64 && sizeof(Instance) == 12 &&
                  sizeof(InstanceMotion) == 12 && sizeof(Affine) == 48 && sizeof(TransformKey) == 52 &&
                  sizeof(Light) == 92 && sizeof(CameraKey) == 48 && sizeof(FilterTable) == 2068 &&
                  sizeof(Shutter) == 2072,
              "elements of the tables that the host uploads as they are");
static_assert(sizeof(EnvironmentMap) == 56 && sizeof(LightSet) == 160 && sizeof(Camera) == 32 &&
                  sizeof(Settings) == 44 && sizeof(SceneView) == 336 && sizeof(LaunchParams) == 496,
              "the kernel's argument");

}  // namespace kadr::kernels
