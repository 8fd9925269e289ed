#include "fake_gpu.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace kadr::test {

using namespace kernels;

FakeGpu::FakeGpu() {
    runtime->on_launch = [this](const std::string& function, const std::byte* argument) {
        if (const std::optional<double> other = run_other(function, argument)) return *other;
        return run(function, argument_of<LaunchParams>(argument));
    };
}

std::unique_ptr<Device> FakeGpu::make() {
    HiprtParts parts;
    parts.runtime = runtime;
    parts.api = FakeHiprt::api();
    parts.kernel_folder = KADR_SOURCE_DIR;
    return make_hiprt_device(std::move(parts));
}

std::string FakeGpu::complaints() const {
    std::string text;
    for (const std::string& fault : runtime->faults) text += "fault: " + fault + "\n";
    for (const std::string& leak : runtime->leaks()) text += "leak: " + leak + "\n";
    for (const std::string& leak : hiprt.leaks()) text += "leak: " + leak + "\n";
    return text;
}

double FakeGpu::run(const std::string& function, const LaunchParams& params) {
    if (function != "kadr_path" && function != "kadr_direct")
        runtime->fault("launch: not a kernel of ours: " + function);
    check_film(params);
    check_frame(params);
    launches.push_back(params);
    std::int64_t samples = 0;
    const auto width = static_cast<std::size_t>(params.scene.settings.width);
    for (int y = params.y0; y < params.y1; ++y)
        for (int x = params.x0; x < params.x1; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x);
            if (params.active && params.active[pixel] == 0) continue;
            for (int s = params.first_sample; s < params.first_sample + params.sample_count; ++s, ++samples) {
                FilmBeauty& beauty = params.film.beauty[pixel];
                beauty.r += static_cast<float>(x);
                beauty.g += static_cast<float>(y);
                beauty.b += static_cast<float>(s);
                beauty.alpha += 1;
                ++params.film.samples[pixel];
                if (params.film.weights) params.film.weights[pixel] += 0.5f;
                if (params.film.depth) params.film.depth[pixel] += 2;
                if (params.film.albedo) params.film.albedo[pixel].y += 3;
                if (params.film.normal) params.film.normal[pixel].z += 4;
                if (params.film.hits) params.film.hits[pixel] += 5;
                if (params.film.motion) params.film.motion[pixel].y += 6;
            }
        }
    params.counters->samples += static_cast<unsigned long long>(samples);
    params.counters->rays += static_cast<unsigned long long>(3 * samples);
    return static_cast<double>(samples) * seconds_a_sample;
}

std::optional<double> FakeGpu::run_other(const std::string& function, const std::byte* argument) {
    if (function == entry_point(Kernel::probe).name) return run_probe(argument_of<ProbeParams>(argument));
    if (function == entry_point(Kernel::bend).name) return run_bend(argument_of<BendParams>(argument));
    if (function == entry_point(Kernel::boxes).name) return run_boxes(argument_of<BoxParams>(argument));
    return std::nullopt;
}

double FakeGpu::run_bend(const BendParams& params) {
    const RestMesh& rest = params.rest;
    const std::size_t vertices = rest.vertex_count, keys = params.poses.key_count, joints = keys * params.poses.joint_count;
    expect(rest.positions, vertices, "positions at rest");
    if (rest.normals) expect(rest.normals, vertices, "normals at rest");
    if (rest.tangents) expect(rest.tangents, vertices, "tangents at rest");
    if (rest.uv) expect(rest.uv, vertices, "texture coordinates at rest");
    const std::size_t slots = vertices * static_cast<std::size_t>(rest.slots);
    if (rest.slots > 0) expect(rest.joints, slots, "joints of vertices");
    if (rest.slots > 0) expect(rest.joint_weights, slots, "weights of joints");
    if (rest.morph_first) {
        expect(rest.morph_first, vertices + 1, "places of morph entries");
        expect(rest.morphs, rest.morph_first[vertices], "morph entries");
        expect(rest.morph_parts, params.poses.target_count, "parts of morph targets");
        expect(params.poses.morph_weights, keys * params.poses.target_count, "morph weights");
    }
    expect(params.poses.matrices, joints, "joint matrices");
    if (params.poses.dual_quaternions) expect(params.poses.dual_quaternions, joints, "dual quaternions");
    expect(params.poses.stretches, keys, "stretches");
    expect(params.vertices, vertices * keys, "bent vertices");
    if (params.tangents) expect(params.tangents, vertices * keys, "bent tangents");
    for (std::size_t i = 0; i < vertices * keys; ++i) bend_vertex(params, i);
    return 1e-6;
}

double FakeGpu::run_boxes(const BoxParams& params) {
    check_geometry(params.geometry);
    expect(params.boxes, params.geometry.triangle_count, "boxes");
    for (unsigned t = 0; t < params.geometry.triangle_count; ++t) params.boxes[t] = box_of(params.geometry, t);
    return 1e-6;
}

double FakeGpu::run_probe(const ProbeParams& params) {
    check_frame(params.frame);
    probes.push_back(params);
    if (params.film_px) {
        expect(params.film_px, params.count, "places on the film");
        expect(params.hits, params.count, "hits");
    } else {
        expect(params.shadows, params.count, "shadow rays");
        expect(params.occluded, params.count, "answers of shadow rays");
    }
    for (unsigned i = 0; i < params.count; ++i)
        if (params.film_px)
            params.hits[i] = {-1, -1, 0, 0, 0, {0, 0, 0}, {0, 0, 0}};
        else
            params.occluded[i] = 1;
    return params.count * 1e-9;
}

void FakeGpu::check_film(const LaunchParams& params) {
    const auto width = static_cast<std::size_t>(params.scene.settings.width);
    const auto rows = static_cast<std::size_t>(params.y1 - params.y0),
               first = static_cast<std::size_t>(params.y0) * width;
    expect(params.film.beauty + first, rows * width, "the film");
    expect(params.film.samples + first, rows * width, "the film's samples");
    if (params.film.weights) expect(params.film.weights + first, rows * width, "the film's weights");
    if (params.film.albedo) expect(params.film.albedo + first, rows * width, "the film's albedo");
    if (params.film.normal) expect(params.film.normal + first, rows * width, "the film's normals");
    if (params.film.depth) expect(params.film.depth + first, rows * width, "the film's depth");
    if (params.film.hits) expect(params.film.hits + first, rows * width, "the film's hits");
    if (params.film.motion) expect(params.film.motion + first, rows * width, "the film's motion");
    if (params.active)
        expect(params.active, width * static_cast<std::size_t>(params.scene.settings.height), "active pixels");
    expect(params.filter, 1, "the filter");
    expect(params.shutter, 1, "the shutter");
    expect(params.counters, 1, "the counters");
}

void FakeGpu::check_frame(const LaunchParams& params) {
    if (!params.top) return;
    const auto scene = hiprt.scenes.find(static_cast<hiprt::Scene>(const_cast<void*>(params.top)));
    if (scene == hiprt.scenes.end() || !scene->second.built)
        return runtime->fault("launch: not a scene that was built");
    for (const auto& [handle, geometry] : hiprt.geometries)
        if (geometry.input.geometry_type != hiprt::kInvalidValue && !params.functions)
            runtime->fault("launch: no function table");
    expect(params.instance_of, scene->second.instances.size(), "the table of instances");
    std::size_t most = 0;
    for (std::size_t i = 0; i < scene->second.instances.size(); ++i)
        most = std::max<std::size_t>(most, params.instance_of[i] + 1);
    check_scene(params.scene, most);
}

void FakeGpu::check_scene(const SceneView& scene, std::size_t instance_count) {
    expect(scene.instances, instance_count, "instances");
    expect(scene.motions, instance_count, "motions");
    for (std::size_t i = 0; i < instance_count; ++i) {
        const InstanceMotion& motion = scene.motions[i];
        if (motion.kind == InstanceMotion::Kind::still)
            expect(scene.matrices + motion.first, 1, "matrices");
        else if (motion.kind == InstanceMotion::Kind::keys)
            expect(scene.keys + motion.first, motion.count, "keys");
        else
            runtime->fault("a linear motion: HIPRT has none");
        expect(scene.geometries + scene.instances[i].geometry, 1, "geometries");
        expect(scene.materials + scene.instances[i].material, 1, "materials");
        check_geometry(scene.geometries[scene.instances[i].geometry]);
        const int texture = scene.materials[scene.instances[i].material].base_color_texture.texture;
        if (texture < 0) continue;
        expect(scene.textures + texture, 1, "textures");
        const Texture& t = scene.textures[texture];
        expect(static_cast<const std::uint8_t*>(t.texels),
               static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height) * 4, "texels");
    }
    if (scene.previous_matrices) expect(scene.previous_matrices, instance_count, "previous matrices");
    expect(scene.camera.keys, static_cast<std::size_t>(scene.camera.key_count), "camera keys");
    const LightSet& lights = scene.lights;
    expect(lights.first, static_cast<std::size_t>(lights.count), "lights");
    expect(lights.key_count, static_cast<std::size_t>(lights.count), "lights");
    for (int i = 0; i < lights.count; ++i)
        expect(lights.keys + lights.first[i], static_cast<std::size_t>(lights.key_count[i]), "light keys");
    expect(lights.triangles, static_cast<std::size_t>(lights.triangle_count), "emissive triangles");
    if (lights.triangle_count > 0)
        expect(lights.triangle_cdf, static_cast<std::size_t>(lights.triangle_count) + 1, "emissive cdf");
    if (lights.triangle_count > 0) expect(lights.instance_density, instance_count, "instance density");
    if (!lights.has_map) return;
    const auto w = static_cast<std::size_t>(lights.map.width), h = static_cast<std::size_t>(lights.map.height);
    expect(lights.map.texels, w * h, "environment");
    expect(lights.map.marginal, h + 1, "environment");
    expect(lights.map.conditional, h * (w + 1), "environment");
}

void FakeGpu::check_geometry(const Geometry& geometry) {
    const std::size_t keys = std::max(geometry.key_count, 1u);
    expect(geometry.vertices, keys * geometry.vertex_count, "vertices");
    expect(geometry.indices, std::size_t{3} * geometry.triangle_count, "indices");
    if (geometry.tangents) expect(geometry.tangents, keys * geometry.vertex_count, "tangents");
    if (geometry.uv1) expect(geometry.uv1, geometry.vertex_count, "second texture coordinates");
    if (geometry.colors) expect(geometry.colors, geometry.vertex_count, "colours");
    if (geometry.previous) expect(geometry.previous, geometry.vertex_count, "previous positions");
}

}  // namespace kadr::test
