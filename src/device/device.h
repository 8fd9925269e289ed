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
    /// Called by the thread of render(), now and then, while it has nothing to do but wait for the device; may call
    /// Device::stage. Not called by devices that do not wait.
    std::function<void()> idle;
};

/// What set_frame did to the acceleration structures: of meshes, of what is flattened, and of all instances together.
struct StructureCounts {
    std::uint64_t built = 0, updated = 0, kept = 0;
    bool operator==(const StructureCounts&) const = default;
};

/// How meshes that bend came to their places in the frame, of those that are shown.
struct BendingCounts {
    std::uint64_t meshes = 0;
    std::uint64_t by_kernels = 0;  ///< whose vertices the device made itself, from poses
    std::uint64_t blurred = 0;     ///< that bend while the shutter is open: triangles whose corners go straight from key to key
    std::uint64_t keys = 0;        ///< most that one has
    bool operator==(const BendingCounts&) const = default;
};

/// Counters since the last set_frame, but for the times of load.
struct DeviceStatistics {
    unsigned required = 0;  ///< kernels::requirement bits that the frame needs
    unsigned compiled = 0;  ///< those that its kernel is compiled for
    std::uint64_t pixel_samples = 0, rays = 0, dropped_samples = 0;
    double load_s = 0, set_frame_s = 0, render_s = 0;
    std::uint64_t staged = 0;  ///< set_frame found its work done while the frame before rendered
    std::string memory_steps;  ///< what was given up because memory was short, since load; empty: nothing
    std::uint64_t flattened_triangles = 0, instances = 0, moving_instances = 0;
    StructureCounts structures;
    BendingCounts bending;
};

/// What the frames of a shot ask of a device's kernels.
struct KernelSet {
    kernels::IntegratorKind integrator = kernels::IntegratorKind::path;
    unsigned requirements = 0;    ///< kernels::requirement bits
    bool asks_functions = false;  ///< rays ask about some hits: partial coverage, culled faces, meshes that bend
    bool operator==(const KernelSet&) const = default;
};

/// Who watches a device.
struct DeviceWatch {
    /// Kernels are being compiled, and a frame waits for them: for how long already. Called now and then by the thread that
    /// waits.
    std::function<void(double seconds)> compiling;
    const std::atomic<bool>* cancel = nullptr;  ///< set: who waits throws Interrupted
};

/// How acceleration structures are built, of a whole shot.
struct BuildSettings {
    BuildQuality quality = BuildQuality::medium;
    /// Whether rays must not slip between triangles that share an edge: `wanted` where the device can do it.
    enum class Robust { no, wanted, required } robust = Robust::no;
    bool operator==(const BuildSettings&) const = default;
};

/// A renderer on some hardware: a few calls, and no back-end type across them.
///
/// A device may keep the sums of a film where it renders, and brings them home when it is asked:
///
///     device.set_frame(snapshot);
///     device.begin_film(film);
///     while (...) device.render(pass, film);
///     device.read_film(film);
class Device {
public:
    virtual ~Device() = default;
    /// Whether it can do what BuildSettings::robust asks for.
    virtual bool has_robust_rays() const { return false; }
    virtual std::string name() const = 0;  ///< "cpu (Embree 3.13.5, 8 lanes, 2 threads)"
    virtual void watch(DeviceWatch) {}     ///< before anything else
    virtual bool compiles() const { return false; }  ///< kernels, when it runs: prepare() is of use
    /// Begins to compile what the frames of a shot ask for, in the background, and returns at once. Before or after load,
    /// from any thread. A frame that asks for more gets a kernel of its own; all leave the same pixels.
    virtual void prepare(const KernelSet&) {}
    /// Once a shot; the scene outlives the device. `environment`: the linear R, G, B of the environment's image,
    /// copied.
    virtual void load(const Scene& scene, const Image* environment, const BuildSettings& build = {}) = 0;
    virtual void set_frame(const SceneSnapshot& snapshot) = 0;
    /// What set_frame will be given next, if all goes well: the very object. A device may make it ready while it renders.
    /// What goes wrong with it is said by set_frame.
    virtual void stage(const std::shared_ptr<const SceneSnapshot>&) {}
    /// The film was cleared, and what comes is for it; sums of another that were not read are forgotten. The film stays
    /// where it is until the next call of begin_film.
    virtual void begin_film(Film&) {}
    /// Adds samples to the film, whose sums are looked at after read_film alone.
    virtual void render(const Pass& pass, Film& film) = 0;
    /// Brings home what render() has added so far; more may be added after that.
    virtual void read_film(Film&) {}
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
    std::string name = "auto";  ///< auto | cpu | hiprt | hiprt:1 | hiprt:0,1
    int threads = 0;            ///< 0: as many as the machine gives
    int width = 0;              ///< lanes; 0: KADR_WIDTH, else what the processor has
    KernelChoice kernels = KernelChoice::by_environment;
};

struct DeviceChoice {
    std::unique_ptr<Device> device;
    std::string why;      ///< "no GPU back end in this build"
    std::string warning;  ///< what is doubtful about it, in a sentence; empty: nothing
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
/// The same for a request that may name several GPUs ("hiprt:0,1"): frames can be dealt out to them.
/// @throws InputError  as make_device; for a GPU that is named twice
std::vector<DeviceChoice> make_devices(const DeviceRequest& request);
std::vector<DeviceReport> list_devices();

}  // namespace kadr
