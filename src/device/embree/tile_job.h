#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>

#include "device/embree/embree_api.h"
#include "kernels/camera/filter.h"
#include "kernels/camera/shutter.h"
#include "kernels/scene/scene_view.h"

namespace kadr {

/// Paths that a tile keeps in flight: enough to fill eight lanes at every depth, few enough for the cache.
inline constexpr int kTileEdge = 16;        ///< pixels
inline constexpr int kSamplesPerBatch = 4;  ///< of every pixel of the tile
inline constexpr int kPathsPerBatch = kTileEdge * kTileEdge * kSamplesPerBatch;

/// What a batch leaves behind, one slot a path: slot = (pixel in the tile) * samples in the batch + sample.
struct alignas(64) TileResult {
    float radiance[3][kPathsPerBatch];
    float weight[kPathsPerBatch];  ///< of the pixel filter (negative lobes); 1 otherwise
    float light[kPathsPerBatch];   ///< weight in time (a split or a rolling shutter); 1 otherwise
    float alpha[kPathsPerBatch];
    float albedo[3][kPathsPerBatch], normal[3][kPathsPerBatch];
    float depth[kPathsPerBatch];  ///< metres along the view axis; infinity for the background
    float motion[2][kPathsPerBatch];
};

struct TileCounters {
    std::uint64_t rays = 0, dropped = 0;
};

/// A ray as it went to Embree; recorded for the benchmark that replays them.
struct LoggedRay {
    float origin[3], direction[3], time, distance;
    bool shadow, flat, camera;
    std::uint8_t packet;  ///< rays of the packet that follow this one, itself included; 1: a single ray
};

/// What a driver needs of the frame.
struct TileJob {
    const kernels::SceneView* scene = nullptr;
    RTCScene flat = nullptr;       ///< geometry relative to the render origin; null when empty
    RTCScene instanced = nullptr;  ///< instances; null when empty
    const kernels::FilterTable* filter = nullptr;
    const kernels::Shutter* shutter = nullptr;
    int first_sample = 0, sample_count = 0;  ///< of this batch
    unsigned seed = 0;                       ///< of the half of the film that the batch belongs to
    int half = 0;
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;      ///< the tile's pixels
    const std::uint8_t* active = nullptr;    ///< of the whole film, [y][x]; null: all pixels
    int film_width = 0;
    bool is_active(int x, int y) const {
        return !active || active[static_cast<std::size_t>(y) * static_cast<std::size_t>(film_width) + static_cast<std::size_t>(x)] != 0;
    }
    bool surface_layers = false;
    void (*log)(void* user, const LoggedRay& ray) = nullptr;  ///< null: do not record
    void* log_user = nullptr;
    bool centred = false;  ///< one sample in all: the pixel's centre, a pinhole, the shutter's opening
};

/// Renders one batch of a tile; one instance per thread (it owns the queues).
class TileDriver {
public:
    virtual ~TileDriver() = default;
    virtual void render(const TileJob& job, TileResult& result, TileCounters& counters) = 0;
};

}  // namespace kadr
