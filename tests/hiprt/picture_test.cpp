// Pictures of the GPU device, whose kernels run here and whose rays are traced by brute force through what HIPRT was
// given: they are those of the CPU. So every table, address, frame and flag that the host hands over is right, whatever
// a GPU will make of it.

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/small_scene.h"
#include "tracing_gpu.h"

namespace kadr::test {
namespace {

using kernels::IntegratorKind;

Film render_on(Device& device, SmallScene& s, int samples, FilmLayers layers) {
    s.snapshot.geometry_key = 1;
    device.load(s.scene, s.environment.width > 0 ? &s.environment : nullptr);
    device.set_frame(s.snapshot);
    Film film(s.snapshot.settings.width, s.snapshot.settings.height, layers);
    film.clear();
    Pass pass;
    pass.sample_count = pass.total_samples = samples;
    device.begin_film(film);
    device.render(pass, film);
    device.read_film(film);
    return film;
}

/// The same samples on both devices. They meet the same points but for rounding; where that flips a hit at an edge or a
/// chance, a sample differs: at most in `most_different` of the pixels.
void expect_same_picture(SmallScene& s, int samples = 16, double most_different = 0.02, float tolerance = 2e-3f) {
    FilmLayers layers;
    layers.albedo = layers.normal = layers.depth = true;
    layers.motion = s.snapshot.previous.has_value();
    DeviceRequest request;
    request.name = "cpu";
    request.threads = 1;
    request.width = 1;
    const DeviceChoice cpu = make_device(request);
    const Image expected = render_on(*cpu.device, s, samples, layers).develop();
    TracingGpu gpu;
    Image image;
    {
        const std::unique_ptr<Device> device = gpu.make();
        image = render_on(*device, s, samples, layers).develop();
        EXPECT_EQ(device->statistics().dropped_samples, cpu.device->statistics().dropped_samples);
        EXPECT_EQ(device->statistics().pixel_samples, cpu.device->statistics().pixel_samples);
        const double rays = static_cast<double>(cpu.device->statistics().rays);
        EXPECT_NEAR(static_cast<double>(device->statistics().rays), rays, 0.01 * rays);
    }
    EXPECT_EQ(gpu.complaints(), "");
    ASSERT_EQ(image.channels, expected.channels);
    const std::size_t channels = image.channels.size(), pixels = image.pixels.size() / channels;
    std::size_t different = 0;
    double lit = 0;
    for (std::size_t i = 0; i < pixels; ++i) {
        bool same = true;
        for (std::size_t c = 0; c < channels; ++c) {
            const float a = image.pixels[i * channels + c], b = expected.pixels[i * channels + c];
            // Positions agree to about 1e-6 of the scene; shading and pdfs amplify that.
            same = same && (a == b || std::abs(a - b) <= tolerance * (1 + std::abs(b)));
        }
        different += same ? 0 : 1;
        lit += expected.pixels[i * channels + 1];
    }
    EXPECT_GT(lit / static_cast<double>(pixels), 0.02) << "a black picture shows nothing";
    EXPECT_LE(static_cast<double>(different), most_different * static_cast<double>(pixels));
}

kernels::Light point_light(kernels::Vec3f position) {
    kernels::Light light;
    light.radiance = {30, 30, 30};
    light.position = position;
    return light;
}

SmallScene lit_scene() {
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = 24;
    s.camera({0, 1, 6}, {0, 0, 0}, 0.4);
    s.add_mesh(unit_square());
    s.add_mesh(unit_sphere(10));
    s.add_instance(0, material({0.8f, 0.7f, 0.6f}, 0, 1),
                   glm::scale(glm::translate(glm::dmat4(1), {0, 0, -2}), glm::dvec3(4)), false);
    s.add_light(point_light({2, 3, 4}));
    return s;
}

glm::dmat4 turned(double degrees, glm::dvec3 position) {
    return glm::rotate(glm::translate(glm::dmat4(1), position), glm::radians(degrees), glm::dvec3(0, 0, 1));
}

TEST(PictureOfGpu, StillAndMovingInstances) {
    SmallScene s = lit_scene();
    s.add_instance(1, material({0.2f, 0.5f, 0.9f}, 0, 0.4f), place({-1, 0, 0}, 0.7), false);
    s.add_moving(0, material({0.9f, 0.2f, 0.2f}, 0, 1),
                 {turned(0, {1, 0, 0}), turned(9, {1.2, 0, 0}), turned(18, {1.4, 0.1, 0})});
    expect_same_picture(s);
}

TEST(PictureOfGpu, MirroredUnevenAndSheared) {
    SmallScene s = lit_scene();
    s.add_instance(1, material({0.2f, 0.5f, 0.9f}, 1, 0.3f), glm::scale(place({-1, 0, 0}), glm::dvec3(-0.5, 1, 0.7)),
                   false);
    glm::dmat4 shear = place({1.2, 0, 0}, 0.7);
    shear[1][0] = 0.4;
    s.add_instance(1, material({0.9f, 0.5f, 0.1f}, 0, 0.5f), shear, false);
    expect_same_picture(s);
}

TEST(PictureOfGpu, ShearedWhileTheyMove) {
    SmallScene s = lit_scene();
    glm::dmat4 shear = place({0, 0, 0}, 0.6);
    shear[1][0] = 0.4;
    // Turning by 20 degrees and travelling, a mirrored one, and one that bends as well.
    s.add_moving(1, material({0.9f, 0.5f, 0.1f}, 0, 0.5f), {turned(0, {1, 0, 0}) * shear, turned(10, {1.1, 0.2, 0}) * shear, turned(20, {1.2, 0.3, 0}) * shear});
    s.add_moving(0, material({0.2f, 0.5f, 0.9f}, 0, 1), {glm::scale(turned(0, {-1, 0.3, 1}) * shear, glm::dvec3(-1, 1, 1)), glm::scale(turned(8, {-1, 0, 1}) * shear, glm::dvec3(-1, 1, 1))});
    s.add_moving(1, material({0.3f, 0.9f, 0.4f}, 0, 0.7f), {turned(0, {-1, -0.6, 0}) * shear, turned(9, {-0.8, -0.6, 0}) * shear});
    auto mesh = std::make_shared<DeformedMesh>();
    mesh->geometry = 1;
    mesh->key_count = 3;
    for (unsigned k = 0; k < 3; ++k)
        for (kernels::Vec3f p : s.scene.geometries[1].positions) {
            const kernels::Vec3f normal = p;
            p.x += 0.2f * static_cast<float>(k) * p.y * p.y;
            mesh->vertices.push_back({p, normal, {0, 0}});
        }
    s.snapshot.deformed = {mesh};
    s.snapshot.instances.edit(3).deformed = 0;
    // Between keys corners go straight, up to 0.05 px beside their way: a hundredth of a metre here, where a pixel is a
    // fifth; shading of surfaces of half a metre follows.
    expect_same_picture(s, 16, 0.02, 0.02f);
}

TEST(PictureOfGpu, CutOutBlendedAndCulledSurfaces) {
    SmallScene s = lit_scene();
    s.snapshot.settings.cull_backfaces = true;
    TextureData texture;
    texture.width = texture.height = 4;
    texture.nearest = true;
    for (int i = 0; i < 16; ++i)
        for (const int value : {200, 180, 40, (i + i / 4) % 2 ? 255 : 0})
            texture.texels.push_back(static_cast<std::uint8_t>(value));
    s.scene.textures.push_back(texture);
    kernels::Material cut = material({1, 1, 1}, 0, 1), blend = cut;
    cut.alpha_mode = kernels::AlphaMode::mask;
    cut.base_color_texture.texture = 0;
    blend.alpha_mode = kernels::AlphaMode::blend;
    blend.alpha = 0.5f;
    s.add_instance(0, cut, place({-1, 0, 0}, 0.8), false);
    s.add_instance(0, blend, place({1, 0, 0.5}, 0.8), false);
    s.add_instance(0, cut, turned(0, {0, 1, 1}) * glm::rotate(glm::dmat4(1), glm::radians(180.0), glm::dvec3(0, 1, 0)),
                   false);
    expect_same_picture(s);
    s.snapshot.settings.integrator = IntegratorKind::direct;
    expect_same_picture(s);
}

TEST(PictureOfGpu, VertexColoursSecondCoordinatesAndNormalMaps) {
    SmallScene s = lit_scene();
    GeometryData rich = unit_square();
    rich.normals.assign(4, {0, 0, 1});
    rich.tangents.assign(4, {1, 0, 0, -1});
    rich.colors = {{1, 0.2f, 0.2f, 1}, {0.2f, 1, 0.2f, 1}, {0.2f, 0.2f, 1, 1}, {1, 1, 0.2f, 1}};
    rich.uv[1] = {{0.1f, 0.9f}, {2, 1}, {1, 0}, {0, 0.3f}};
    TextureData bumps;
    bumps.width = bumps.height = 4;
    bumps.format = kernels::TexelFormat::rgba8_linear;
    for (int i = 0; i < 64; ++i)
        bumps.texels.push_back(static_cast<std::uint8_t>(i % 4 == 2 ? 255 : 100 + 37 * i % 60));
    TextureData colors = bumps;
    colors.format = kernels::TexelFormat::rgba8_srgb;
    s.scene.textures = {bumps, colors};
    kernels::Material m = material({1, 1, 1}, 0, 0.4f);
    m.normal_texture.texture = 0;
    m.base_color_texture.texture = 1;
    m.base_color_texture.uv_set = 1;
    s.add_instance(s.add_mesh(rich), m, turned(20, {0.5, 0, 1}), false);
    expect_same_picture(s);
}

TEST(PictureOfGpu, LightsEmittersAndEnvironment) {
    SmallScene s = lit_scene();
    s.environment.width = 8;
    s.environment.height = 4;
    s.environment.channels = {"R", "G", "B"};
    for (int i = 0; i < 96; ++i) s.environment.pixels.push_back(0.1f * static_cast<float>(i % 7));
    s.snapshot.environment.radiance = {1, 1, 1};
    kernels::Light area;
    area.kind = kernels::LightKind::area;
    area.radiance = {5, 5, 4};
    area.position = {0, 3, 0};
    area.direction = {0, -1, 0};
    area.axis_u = {1, 0, 0};
    area.axis_v = {0, 0, 1};
    s.add_light(area);
    kernels::Material glowing = material({0, 0, 0}, 0, 1);
    glowing.emission = {3, 1, 1};
    s.add_instance(1, glowing, place({1, -0.5, 0}, 0.5), false);
    s.add_instance(1, material({1, 1, 1}, 1, 0.1f), place({-1, 0, 0}, 0.8), false);
    expect_same_picture(s);
}

TEST(PictureOfGpu, BendingMeshesStillAndBlurred) {
    for (const unsigned keys : {1u, 3u}) {
        SmallScene s = lit_scene();
        s.add_instance(1, material({0.9f, 0.3f, 0.6f}, 0, 0.6f), place({0, 0, 0}), false);
        auto mesh = std::make_shared<DeformedMesh>();
        mesh->geometry = 1;
        mesh->key_count = keys;
        for (unsigned k = 0; k < keys; ++k)
            for (kernels::Vec3f p : s.scene.geometries[1].positions) {
                const kernels::Vec3f normal = p;
                p.x += 0.3f * static_cast<float>(k) * p.y * p.y;
                mesh->vertices.push_back({p, normal, {0, 0}});
            }
        s.snapshot.deformed = {mesh};
        s.snapshot.instances.edit(1).deformed = 0;
        expect_same_picture(s);
    }
}

TEST(PictureOfGpu, MotionSinceTheFrameBefore) {
    SmallScene s = lit_scene();
    s.add_instance(1, material({0.9f, 0.3f, 0.6f}, 0, 0.6f), place({0, 0, 0}), false);
    s.snapshot.previous.emplace();
    s.snapshot.previous->space_from_geometry = {
        s.snapshot.motion.headers.empty() ? place({0, 0, 0}) : place({0, 0, -2}, 4), place({-0.5, 0, 0})};
    s.snapshot.previous->camera = s.snapshot.camera_keys[0];
    expect_same_picture(s);
}

}  // namespace
}  // namespace kadr::test
