// float and eight lanes do the same operations: results agree to the last bit.
#include <gtest/gtest.h>

#include <array>
#include <cstring>

#include "kernels/camera/filter_table.h"
#include "kernels/lanes_cases.h"
#include "kernels/light/environment_tables.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

constexpr float kHalf = 0.70710678f;

/// A world with one of everything.
class World {
public:
    World() {
        cameras_[0] = {keys_.data(), 3, false, 0, 0, 1e30f};
        cameras_[1] = {keys_.data(), 1, false, 6, 0, 1e30f};
        cameras_[2] = {keys_.data(), 2, true, 0, 0, 1e30f};
        build_filter(FilterKind::box, 0.5f, filters_[0]);
        build_filter(FilterKind::gaussian, 1.5f, filters_[1]);
        build_filter(FilterKind::mitchell, 2.0f, filters_[2]);
        build_filter(FilterKind::blackman_harris, 0.75f, filters_[3]);
        make_shutters();
        make_lights();
        Random random(3);
        for (Vec3f& t : texels_) t = {random(), random() * random(), random()};
        environment_ = {texels_.data(), 16, 8, marginal_.data(), conditional_.data(), 0.7f, {1.0f, 2.0f, 3.0f}, 1.0f};
        build_environment_tables(texels_.data(), 16, 8, marginal_.data(), conditional_.data());
        for (unsigned char& b : bytes_) b = static_cast<unsigned char>(random() * 256.0f);
        textures_ = {{{bytes_.data(), 8, 4, TexelFormat::rgba8_srgb, Wrap::repeat, Wrap::mirrored_repeat, false},
                      {bytes_.data(), 8, 4, TexelFormat::rgba16_srgb, Wrap::clamp_to_edge, Wrap::repeat, false},
                      {bytes_.data(), 8, 4, TexelFormat::rgba16_linear, Wrap::repeat, Wrap::repeat, true},
                      {texels_.data(), 4, 4, TexelFormat::rgba32f, Wrap::mirrored_repeat, Wrap::repeat, false}}};
        for (std::size_t i = 0; i < lights_.size(); ++i) pointers_[i] = lights_[i].data();
        world_ = {cameras_.data(),
                  3,
                  filters_.data(),
                  4,
                  pointers_.data(),
                  counts_.data(),
                  static_cast<int>(lights_.size()),
                  &environment_,
                  textures_.data(),
                  4,
                  shutters_.data(),
                  static_cast<int>(shutters_.size())};
    }
    const CaseWorld& get() const { return world_; }

private:
    /// Plain; a curve; a rolling one cut by its part; lines that open in an instant.
    void make_shutters() {
        constexpr float kN = Shutter::kIntervals;
        for (std::size_t s = 1; s < shutters_.size(); ++s) {
            shutters_[s].plain = false;
            for (int i = 0; i <= Shutter::kIntervals; ++i) shutters_[s].passed[i] = static_cast<float>(i) * static_cast<float>(i) / (kN * kN);
        }
        shutters_[2].direction = RollingDirection::up;
        shutters_[2].first_open = -0.4f, shutters_[2].delay = 0.9f, shutters_[2].length = 0.7f, shutters_[2].weight = 1.7f;
        shutters_[3] = shutters_[2];
        shutters_[3].direction = RollingDirection::right, shutters_[3].length = 0.0f;
    }
    void make_lights() {
        for (std::size_t i = 0; i < lights_.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                Light& l = lights_[i][k];
                l.radiance = {1.0f + k, 2.0f, 3.0f - k};
                l.position = {0.3f * k, 0.1f, -0.2f};
                l.direction = normalize(Vec3f{0.2f, -1.0f, 0.1f * k});
                l.axis_u = {0.5f, 0.1f, 0.0f};
                l.axis_v = cross(l.direction, l.axis_u);
                l.inner_rad = 0.4f, l.outer_rad = 1.2f;
                l.cos_inner = 0.921061f, l.cos_outer = 0.362358f;
                l.range = i % 2 == 0 ? 0.0f : 4.0f;
                l.kind = i < 2   ? LightKind::directional
                         : i < 4 ? LightKind::point
                         : i < 7 ? LightKind::spot
                                 : LightKind::area;
                if (i == 1) l.one_minus_cos = 0.01f;
                if (i == 3 || i == 6) l.radius = 0.25f;
                if (l.kind == LightKind::spot) l.falloff = static_cast<SpotFalloff>(i - 4);
            }
        }
    }

    std::array<CameraKey, 3> keys_{{{{0, 0, 0}, {0, 0, 0, 1}, 0.5f, 0.4f, 0.1f, 2.0f},
                                    {{0, 1, 0}, {0, 0.08715574f, 0, 0.9961947f}, 0.6f, 0.5f, 0.0f, 3.0f},
                                    {{0, 2, 1}, {0, -0.17364818f, 0, -0.98480775f}, 0.7f, 0.5f, 0.1f, 2.0f}}};
    std::array<Camera, 3> cameras_;
    std::array<FilterTable, 4> filters_;
    std::array<Shutter, 4> shutters_;
    std::array<std::array<Light, 3>, 9> lights_;
    std::array<const Light*, 9> pointers_;
    std::array<int, 9> counts_{1, 3, 2, 1, 3, 1, 2, 1, 3};
    std::array<Vec3f, 16 * 8> texels_;
    std::array<float, 9> marginal_;
    std::array<float, 8 * 17> conditional_;
    EnvironmentMap environment_;
    std::array<unsigned char, 8 * 4 * 8> bytes_;
    std::array<Texture, 4> textures_;
    CaseWorld world_;
};

using Block = std::array<float, 8 * kCaseInputs>;
using Results = std::array<float, 8 * kCaseOutputs>;

/// Numbers in [0, 1), a tenth of them at the ends.
void fill(Random& random, float* block) {
    for (int i = 0; i < 8 * kCaseInputs; ++i) {
        const float u = random();
        block[i] = u < 0.05f ? 0.0f : u < 0.1f ? kOneMinusEpsilon : random();
    }
}

TEST(Lanes, AgreeToTheLastBit) {
    if (!__builtin_cpu_supports("avx2")) GTEST_SKIP() << "this processor has no AVX2";
    const World world;
    Random random(11);
    alignas(32) Block inputs;
    alignas(32) Results narrow, wide;
    for (int round = 0; round < 2000; ++round) {
        fill(random, inputs.data());
        for (int index = 0; index < 8 + world.get().light_count; ++index) {
            run_case<float>(world.get(), index, inputs.data(), narrow.data());
            run_case_avx2(world.get(), index, inputs.data(), wide.data());
            for (std::size_t i = 0; i < narrow.size(); ++i) {
                ASSERT_EQ(as_uint(narrow[i]), as_uint(wide[i]))
                    << "case " << index << ", output " << i / 8 << ", lane " << i % 8 << ", round " << round << ": "
                    << narrow[i] << " and " << wide[i];
                ASSERT_TRUE(is_finite(narrow[i])) << "case " << index << ", output " << i / 8 << ", round " << round;
            }
        }
    }
}

TEST(Gather, FindsTheIntervalOfEveryValue) {
    const float table[] = {0.0f, 0.0f, 0.25f, 0.25f, 0.5f, 1.0f};
    EXPECT_EQ(find_interval<float>(table, 0, 5, 0.0f), 1);
    EXPECT_EQ(find_interval<float>(table, 0, 5, 0.2f), 1);
    EXPECT_EQ(find_interval<float>(table, 0, 5, 0.25f), 3);
    EXPECT_EQ(find_interval<float>(table, 0, 5, 0.75f), 4);
    EXPECT_EQ(find_interval<float>(table, 2, 3, 0.3f), 3);
}

TEST(Math, SinesAndArcsStayWithinTheirErrors) {
    for (int i = -2000; i <= 2000; ++i) {
        float s, c;
        sincos_2pi(i / 1000.0f, s, c);
        EXPECT_NEAR(s, std::sin(2.0 * M_PI * i / 1000.0), 1e-6);  // 4e-7 and the float of the argument, 4e-7
        EXPECT_NEAR(c, std::cos(2.0 * M_PI * i / 1000.0), 1e-6);
        const double a = M_PI * i / 2000.0;
        EXPECT_NEAR(atan2_turns(static_cast<float>(std::sin(a)), static_cast<float>(std::cos(a))), a / (2.0 * M_PI),
                    2e-7);
    }
    EXPECT_EQ(atan2_turns(0.0f, 0.0f), 0.0f);
}

}  // namespace
}  // namespace kadr::kernels
