#include "render/memory_forecast.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "device/embree/memory_forecast.h"
#include "kernels/scene/scene_view.h"
#include "output/image_io.h"
#include "render/frame_cache.h"
#include "render/frame_memory.h"

namespace kadr {
namespace {

template <class T>
double bytes_of(const std::vector<T>& values) {
    return static_cast<double>(values.size() * sizeof(T));
}

double bytes_of(const GeometryData& g) {
    double bytes = bytes_of(g.positions) + bytes_of(g.normals) + bytes_of(g.indices) + bytes_of(g.tangents) + bytes_of(g.uv[0]) + bytes_of(g.uv[1]) + bytes_of(g.colors) +
                   bytes_of(g.skin.joints) + bytes_of(g.skin.weights);
    for (const MorphTarget& target : g.targets) bytes += bytes_of(target.vertices) + bytes_of(target.positions) + bytes_of(target.normals) + bytes_of(target.tangents);
    return bytes;
}

double texel_bytes(const TextureData& texture) {
    const bool wide = texture.format == kernels::TexelFormat::rgba16_srgb || texture.format == kernels::TexelFormat::rgba16_linear;
    return (wide ? 8.0 : 4.0) * texture.width * texture.height;
}

template <class T>
double bytes_of_track(const std::optional<Track<T>>& track) {
    return track ? bytes_of(track->keys) : 0;
}

double bytes_of_trees(const Scene& scene) {
    double bytes = bytes_of(scene.nodes) + bytes_of(scene.materials) + bytes_of(scene.material_sources);
    for (const std::vector<Placement>& set : scene.placement_sets) bytes += bytes_of(set);
    for (const Clip& clip : scene.clips)
        for (const NodeChannels& channels : clip.channels) {
            bytes += sizeof(NodeChannels) + bytes_of_track(channels.translation) + bytes_of_track(channels.scale) + bytes_of_track(channels.rotation);
            for (const Track<double>& weights : channels.weights) bytes += bytes_of(weights.keys);
        }
    return bytes;
}

/// What snapshots share is there once, their own entries in each of `held` frames.
template <class T>
double bytes_of(const std::vector<SceneSnapshot>& parts, double held, SharedList<T> SceneSnapshot::*list) {
    double bytes = static_cast<double>((parts.front().*list).shared_size() * sizeof(T));
    for (const SceneSnapshot& part : parts) bytes += held * bytes_of((part.*list).own());
    return bytes;
}
template <class T>
double bytes_of(const std::vector<SceneSnapshot>& parts, double held, SharedList<T> MotionFrames::*list) {
    double bytes = static_cast<double>((parts.front().motion.*list).shared_size() * sizeof(T));
    for (const SceneSnapshot& part : parts) bytes += held * bytes_of((part.motion.*list).own());
    return bytes;
}

double bytes_of_motion(const std::vector<SceneSnapshot>& parts, double held) {
    return bytes_of(parts, held, &SceneSnapshot::instances) + bytes_of(parts, held, &SceneSnapshot::fixed_places) + bytes_of(parts, held, &MotionFrames::headers) +
           bytes_of(parts, held, &MotionFrames::types) + bytes_of(parts, held, &MotionFrames::srt) + bytes_of(parts, held, &MotionFrames::matrices) +
           bytes_of(parts, held, &MotionFrames::linear);
}

/// Vertices of the frames held, and those of the frame before that the device and the cache hold until they are replaced.
double bytes_of_bending(const std::vector<SceneSnapshot>& parts, double held) {
    double bytes = 0;
    for (const SceneSnapshot& part : parts)
        for (const auto& mesh : part.deformed) bytes += bytes_of(mesh->vertices) + bytes_of(mesh->tangents);
    return (1 + held) * bytes;
}

/// Triangles that shine, as next-event estimation chooses among them: the entry, its share and, while the table is made,
/// its sum and its place (EmitterTables).
double bytes_of_emitters(const Scene& scene, const SceneSnapshot& snapshot) {
    constexpr double kEntry = sizeof(kernels::EmissiveTriangle) + sizeof(float), kMaking = sizeof(double) + 4 * sizeof(double);
    const std::vector<kernels::Material>& materials = snapshot.materials.empty() ? scene.materials : snapshot.materials;
    double triangles = 0;
    for (const SnapshotInstance& instance : snapshot.instances) {
        const kernels::Material& m = materials[instance.material];
        if (instance.mask != 0 && !m.unlit && m.emission.x + m.emission.y + m.emission.z > 0) triangles += static_cast<double>(scene.geometries[instance.geometry].indices.size()) / 3;
    }
    return triangles * (kEntry + kMaking);
}

/// What wakes up when the program works: more of its libraries, stacks, heaps, queues of paths. Measured as the peak of a
/// picture of 48 x 32 on 1 to 32 threads, less the program that has opened its libraries and read nothing.
double working_bytes(int threads) { return 17e6 + 0.35e6 * threads; }

/// A part at each of the moments that may take the most.
enum Moment { loading, building, level, finishing, kMoments };
constexpr const char* kMomentNames[] = {"the files are read", "structures are built", "the instances' structure is built", "a frame is finished and written"};
struct Row {
    std::string name, of;
    std::array<double, kMoments> bytes{};
};

class Forecast {
public:
    Forecast(const LoadedShot& shot, const std::vector<SceneSnapshot>& parts, const RenderExtent& extent) : shot_(shot), parts_(parts), extent_(extent) {}

    MemoryForecast make() {
        const double program = extent_.program_bytes + working_bytes(extent_.threads);
        add("program", fmt::format("with its libraries, measured now, and {} thread{}", extent_.threads, extent_.threads == 1 ? "" : "s"), {program, program, program, program});
        add_scene();
        add_environment();
        add_device();
        add_film();
        return at_the_peak();
    }

private:
    void add(std::string name, std::string of, std::array<double, kMoments> bytes) { rows_.push_back({std::move(name), std::move(of), bytes}); }

    void add_scene() {
        const Scene& scene = shot_.scene();
        double geometry = bytes_of_trees(scene), triangles = 0, read = 0;
        for (const GeometryData& one : scene.geometries) geometry += bytes_of(one), triangles += static_cast<double>(one.indices.size()) / 3;
        for (std::size_t file = 0; file < scene.files.size(); ++file)
            if (is_first(file)) read += static_cast<double>(scene.files[file].read_bytes);
        add("files", "the parts of glTF files and images that are read", {read, 0, 0, 0});
        add("geometry", fmt::format("{} meshes, {:.0f} triangles, {} nodes", scene.geometries.size(), triangles, scene.nodes.size()), {geometry, geometry, geometry, geometry});
        std::vector<double> textures;
        for (const TextureData& texture : scene.textures) textures.push_back(texel_bytes(texture));
        const double all = std::accumulate(textures.begin(), textures.end(), 0.0);
        // Each thread decodes one image at a time, and the decoder has a copy of its own.
        std::sort(textures.rbegin(), textures.rend());
        textures.resize(std::min<std::size_t>(textures.size(), std::max(1u, std::thread::hardware_concurrency())));
        const double decoding = std::accumulate(textures.begin(), textures.end(), 0.0);
        add("textures", fmt::format("{} images", scene.textures.size()), {all + decoding, all, all, all});
    }

    bool is_first(std::size_t file) const {
        const auto& files = shot_.scene().files;
        return std::none_of(files.begin(), files.begin() + static_cast<std::ptrdiff_t>(file), [&](const SceneFile& other) { return other.path == files[file].path; });
    }

    void add_environment() {
        const EnvironmentSpec& environment = shot_.shot().environment;
        if (!environment.given || !environment.image) return;
        const ImageExtent extent = image_io().extent(*environment.image);
        // Texels and the table of their columns; while it is loaded, the image as it is and its colours.
        const double pixels = static_cast<double>(extent.width) * extent.height, kept = pixels * (sizeof(kernels::Vec3f) + sizeof(float));
        add("environment", fmt::format("an image of {} x {}", extent.width, extent.height),
            {kept + pixels * static_cast<double>(sizeof(kernels::Vec3f) + static_cast<std::size_t>(extent.channels) * sizeof(float)), kept, kept, kept});
    }

    void add_device() {
        DeviceMemory most;
        double emitters = 0;
        for (const SceneSnapshot& part : parts_) {
            const DeviceMemory memory = forecast_device_memory(shot_.scene(), part);
            if (memory.structures + memory.instances >= most.structures + most.instances) most = memory;
            emitters = std::max(emitters, bytes_of_emitters(shot_.scene(), part));
        }
        add("vertices", "as rays find them, beside the files' own", {0, most.vertices, most.vertices, most.vertices});
        add("structures", "over triangles", {0, most.structures + most.building, most.structures, most.structures});
        const double held = extent_.frames > 1 ? 2 : 1;  // the next frame is evaluated while one renders
        const double motion = bytes_of_motion(parts_, held);
        add("instances", fmt::format("{} and their motion", parts_.front().instances.size()), {0, motion, motion + most.instances + most.instances_building, motion + most.instances});
        if (const double bending = bytes_of_bending(parts_, held); bending > 0) add("bending", "vertices of meshes that bend", {0, bending, bending, bending});
        if (emitters > 0) add("lights", "triangles that shine", {0, 0, emitters, emitters});
    }

    void add_film() {
        const Shot& shot = shot_.shot();
        const FrameBytes frame = frame_bytes(shot, parts_.size(), parts_.size() > 1 || !parts_.front().shutter.plain);
        add("film", fmt::format("{} x {} pixels", shot.image.width, shot.image.height), {0, frame.sums, frame.sums, frame.finishing()});
        const double cached = std::min<double>(extent_.frames - 1, std::max(1.0, std::floor(static_cast<double>(kMostCachedBytes) / frame.image)));
        add("frames", fmt::format("{:.0f} kept in case they come again{}", cached, frame.encoding > 0 ? ", one on its way into the video" : ""),
            {0, 0, 0, cached * frame.image + frame.encoding});
    }

    MemoryForecast at_the_peak() const {
        std::array<double, kMoments> totals{};
        for (const Row& row : rows_)
            for (std::size_t moment = 0; moment < kMoments; ++moment) totals[moment] += row.bytes[moment];
        const auto peak = static_cast<std::size_t>(std::max_element(totals.begin(), totals.end()) - totals.begin());
        MemoryForecast forecast;
        forecast.moment = kMomentNames[peak];
        for (const Row& row : rows_)
            if (row.bytes[peak] > 0) forecast.parts.push_back({row.name, row.bytes[peak], row.of});
        return forecast;
    }

    const LoadedShot& shot_;
    const std::vector<SceneSnapshot>& parts_;
    const RenderExtent& extent_;
    std::vector<Row> rows_;
};

}  // namespace

double MemoryForecast::total() const {
    return std::accumulate(parts.begin(), parts.end(), 0.0, [](double sum, const MemoryPart& part) { return sum + part.bytes; });
}

MemoryForecast forecast_memory(const LoadedShot& shot, const std::vector<SceneSnapshot>& parts, const RenderExtent& extent) { return Forecast(shot, parts, extent).make(); }

}  // namespace kadr
