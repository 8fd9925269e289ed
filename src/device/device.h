#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "device/probe.h"
#include "film/film.h"
#include "frame/snapshot.h"

namespace kadr {

/// Samples [first_sample, first_sample + sample_count) of one half of the film, of every active pixel.
struct Pass {
    int first_sample = 0, sample_count = 1;
    int half = 0;                                   ///< of the film; halves are scrambled independently of each other
    const std::uint8_t* active = nullptr;           ///< [y][x], 0: this pixel has samples enough; null: all are active
    /// Share of the frame's samples that this part of the shutter was dealt: what each of them counts for is the light
    /// of the part over this share. 0: the part's own weight.
    double dealt_share = 0;
    int total_samples = 0;                          ///< of the frame; 1 under `direct`: pixel centres, pinhole, no blur
    const std::atomic<bool>* cancel = nullptr;      ///< set: return early (film is then incomplete)
    std::function<void(double fraction)> progress;  ///< 0..1, called from any thread, rarely
};

/// What set_frame did to the acceleration structures: of meshes, of what is flattened, and of all instances together.
struct StructureCounts {
    std::uint64_t built = 0, updated = 0, kept = 0;
    bool operator==(const StructureCounts&) const = default;
};

/// Counters since the last set_frame, but for the times of load.
struct DeviceStatistics {
    unsigned required = 0;  ///< kernels::requirement bits that the frame needs
    unsigned compiled = 0;  ///< those that its kernel is compiled for
    std::uint64_t pixel_samples = 0, rays = 0, dropped_samples = 0;
    double load_s = 0, set_frame_s = 0, render_s = 0;
    std::uint64_t flattened_triangles = 0, instances = 0, moving_instances = 0;
    StructureCounts structures;
};

/// How acceleration structures are built, of a whole shot.
struct BuildSettings {
    BuildQuality quality = BuildQuality::medium;
    /// Whether rays must not slip between triangles that share an edge: `wanted` where the device can do it.
    enum class Robust { no, wanted, required } robust = Robust::no;
    bool operator==(const BuildSettings&) const = default;
};

/// A renderer on some hardware: three calls, and no back-end type across them.
class Device {
public:
    virtual ~Device() = default;
    /// Whether it can do what BuildSettings::robust asks for.
    virtual bool has_robust_rays() const { return false; }
    virtual std::string name() const = 0;  ///< "cpu (Embree 3.13.5, 8 lanes, 2 threads)"
    /// Once a shot; the scene outlives the device. `environment`: the linear R, G, B of the environment's image,
    /// copied.
    virtual void load(const Scene& scene, const Image* environment, const BuildSettings& build = {}) = 0;
    virtual void set_frame(const SceneSnapshot& snapshot) = 0;
    virtual void render(const Pass& pass, Film& film) = 0;  ///< adds to the film
    virtual DeviceStatistics statistics() const = 0;
    /// Single rays, of devices that answer them; else null. Lives as long as the device.
    virtual Probe* probe() { return nullptr; }
};

/// Kernels are compiled for several sets of requirements (kernels::requirement). All leave the same pixels.
enum class KernelChoice : std::uint8_t {
    by_environment,  ///< what KADR_KERNEL_SET says: needed or all; needed without it
    needed,          ///< the smallest set that holds what the frame needs
    all,             ///< the set that holds everything, whatever the frame needs: for comparisons
};

struct DeviceRequest {
    std::string name = "auto";  ///< auto | cpu | hiprt
    int threads = 0;            ///< 0: as many as the machine gives
    int width = 0;              ///< lanes; 0: KADR_WIDTH, else what the processor has
    KernelChoice kernels = KernelChoice::by_environment;
};

struct DeviceChoice {
    std::unique_ptr<Device> device;
    std::string why;  ///< "no GPU back end in this build"
};

/// One line of `kadr devices`.
struct DeviceReport {
    std::string name;         ///< "cpu", "hiprt"
    std::string description;  ///< hardware
    bool usable = false;
    std::string reason;  ///< why not, when not
};

/// @throws InputError  for an unknown name or a device that is not usable, with the reason
DeviceChoice make_device(const DeviceRequest& request);
std::vector<DeviceReport> list_devices();

}  // namespace kadr
