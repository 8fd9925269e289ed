// The film stays on the GPU while a frame renders, and comes home when it is asked for.

#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/small_scene.h"
#include "fake_gpu.h"

namespace kadr::test {
namespace {

FilmLayers with_depth() {
    FilmLayers layers;
    layers.depth = true;
    return layers;
}

/// A GPU whose samples have values that do not add up exactly: sums depend on the order of their samples.
struct RoundingGpu : FakeGpu {
    RoundingGpu() {
        runtime->on_launch = [](const std::string&, const std::byte* argument) {
            kernels::LaunchParams params;
            std::memcpy(static_cast<void*>(&params), argument, sizeof params);
            const int width = params.scene.settings.width;
            for (int y = params.y0; y < params.y1; ++y)
                for (int x = params.x0; x < params.x1; ++x)
                    for (int s = params.first_sample; s < params.first_sample + params.sample_count; ++s) {
                        const auto pixel = static_cast<std::size_t>(y * width + x);
                        const double value = std::sin(1.0 + x + 7 * y + 13 * s + 31.0 * params.seed);
                        params.film.beauty[pixel].r += value;
                        params.film.beauty[pixel].alpha += 1;
                        ++params.film.samples[pixel];
                        params.film.weights[pixel] += value * value;
                        params.film.depth[pixel] += value;
                    }
            return 1e-9;
        };
    }
};

/// Every sum of the film.
std::vector<double> sums(Film& film) {
    std::vector<double> all;
    for (int half = 0; half < Film::kHalves; ++half)
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x)
                for (const double value :
                     {film.beauty(x, y, half).r, film.beauty(x, y, half).alpha, film.weight(x, y, half),
                      film.surface(x, y).depth, static_cast<double>(film.samples(x, y, half))})
                    all.push_back(value);
    return all;
}

/// Five rounds in both halves. @param between  called after each round
std::vector<double> render_rounds(Device& device, SmallScene& s, const std::function<void(Film&)>& between = {}) {
    device.load(s.scene, nullptr);
    device.set_frame(s.snapshot);
    Film film(s.snapshot.settings.width, s.snapshot.settings.height, with_depth());
    film.clear(true);
    device.begin_film(film);
    for (int round = 0; round < 5; ++round) {
        for (int half = 0; half < Film::kHalves; ++half) {
            Pass pass;
            pass.half = half;
            pass.first_sample = 3 * round;
            pass.sample_count = 3;
            pass.total_samples = 30;
            device.render(pass, film);
        }
        if (between) between(film);
    }
    device.read_film(film);
    return sums(film);
}

SmallScene one_square(int edge) {
    SmallScene s;
    s.snapshot.settings.width = s.snapshot.settings.height = edge;
    s.add_instance(s.add_mesh(unit_square()), material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    s.snapshot.geometry_key = 1;
    return s;
}

TEST(FilmOnGpu, ComesHomeOnceAFrame) {
    RoundingGpu gpu;
    SmallScene s = one_square(32);
    {
        const std::unique_ptr<Device> device = gpu.make();
        std::size_t before = 0;
        render_rounds(*device, s, [&](Film& film) {
            before = gpu.runtime->count("download");
            EXPECT_EQ(film.samples(3, 3), 0u);  // it is not here
        });
        EXPECT_EQ(before, 10u);  // the counters of ten passes
        // Beauty, samples and weights of both halves, depth and its weight.
        EXPECT_EQ(gpu.runtime->count("download"), before + 8);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(FilmOnGpu, TheSameBitsHoweverMuchOfItFitsAndWheneverItIsRead) {
    SmallScene s = one_square(64);
    RoundingGpu plenty;
    const std::vector<double> expected = render_rounds(*plenty.make(), s);
    ASSERT_NE(expected[0], 0);
    // Read after every round.
    RoundingGpu read;
    {
        const std::unique_ptr<Device> device = read.make();
        EXPECT_EQ(render_rounds(*device, s, [&](Film& film) { device->read_film(film); }), expected);
    }
    EXPECT_EQ(read.complaints(), "");
    // The whole film takes 64 * 64 * (2 * 44 + 16) bytes, one half 246 kB; less and less of it fits.
    const std::size_t rest = plenty.runtime->most_in_use() - 64 * 64 * (2 * 44 + 16);
    for (const std::size_t film_bytes : {400'000, 250'000, 150'000, 50'000, 9'000}) {
        RoundingGpu little;
        little.runtime->capacity = rest + film_bytes;
        {
            const std::unique_ptr<Device> device = little.make();
            EXPECT_EQ(render_rounds(*device, s), expected) << film_bytes;
            EXPECT_EQ(device->statistics().memory_steps, "");  // of the frame that began with memory enough
            device->set_frame(s.snapshot);
            EXPECT_EQ(device->statistics().memory_steps, "the film comes in parts");
        }
        EXPECT_EQ(little.complaints(), "") << film_bytes;
    }
}

TEST(FilmOnGpu, GoesHomeWhenAFrameNeedsTheMemory) {
    SmallScene s = one_square(64), large = one_square(64);
    large.add_instance(large.add_mesh(unit_sphere(24)), material({1, 1, 1}, 0, 1), place({0, 0, 0}), false);
    large.snapshot.geometry_key = 2;
    const auto render = [&](RoundingGpu& gpu, std::size_t room) {
        const std::unique_ptr<Device> device = gpu.make();
        bool first = true;
        return render_rounds(*device, large, [&](Film&) {
            if (!std::exchange(first, false)) return;
            gpu.runtime->capacity = gpu.runtime->in_use() + room;
            // Another part of the shutter, which shows more than fits beside the film.
            SceneSnapshot other = large.snapshot;
            other.geometry_key = 3;
            other.instances.edit(0).material = 0;
            for (int i = 0; i < 300; ++i) {
                other.instances.push_back(other.instances[0]);
                other.motion.headers.push_back(other.motion.headers[0]);
                other.motion.types.push_back(other.motion.types[0]);
                other.motion.linear.push_back(0);
            }
            device->set_frame(other);
        });
    };
    RoundingGpu plenty, little;
    const std::vector<double> expected = render(plenty, std::size_t{1} << 29);
    EXPECT_EQ(render(little, 2000), expected);
    EXPECT_GT(little.runtime->count("upload"), plenty.runtime->count("upload"));  // it went home, and came back
    EXPECT_EQ(plenty.complaints(), "");
    EXPECT_EQ(little.complaints(), "");
}

TEST(FilmOnGpu, WhatDoesNotChangeIsCopiedOnce) {
    FakeGpu gpu;
    SmallScene s = one_square(32);
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr);
        device->set_frame(s.snapshot);
        Film film(32, 32, {});
        film.clear();
        device->begin_film(film);
        std::vector<std::uint8_t> active(32 * 32, 1);
        Pass pass;
        pass.active = active.data();
        pass.total_samples = 8;
        const auto uploads_of_pass = [&] {
            const std::size_t before = gpu.runtime->count("upload");
            device->render(pass, film);
            return gpu.runtime->count("upload") - before;
        };
        EXPECT_EQ(uploads_of_pass(), 3u);  // the shutter, active pixels, counters
        EXPECT_EQ(uploads_of_pass(), 1u);  // counters
        active[5] = 0;
        EXPECT_EQ(uploads_of_pass(), 2u);
        EXPECT_EQ(gpu.launches.back().active[5], 0);
        pass.dealt_share = 0.5;
        EXPECT_EQ(uploads_of_pass(), 2u);
        EXPECT_EQ(gpu.launches.back().shutter->weight, 2.0f);
        device->read_film(film);
        EXPECT_EQ(film.samples(4, 0), 4u);
        EXPECT_EQ(film.samples(5, 0), 2u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

TEST(FilmOnGpu, AFilmThatWasNotAnnouncedIsTakenAsItIs) {
    FakeGpu gpu;
    SmallScene s = one_square(32);
    {
        const std::unique_ptr<Device> device = gpu.make();
        device->load(s.scene, nullptr);
        device->set_frame(s.snapshot);
        Film one(32, 32, {}), other(32, 32, {});
        one.clear();
        other.clear();
        other.samples(3, 3) = 5;
        device->begin_film(one);
        device->render({}, one);
        device->render({}, other);
        EXPECT_EQ(one.samples(3, 3), 1u);  // it had to go home
        device->read_film(other);
        EXPECT_EQ(other.samples(3, 3), 6u);
    }
    EXPECT_EQ(gpu.complaints(), "");
}

}  // namespace
}  // namespace kadr::test
