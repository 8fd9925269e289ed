#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "kernels/sampler/sobol.h"
#include "kernels/sampler/warp.h"
#include "kernels/statistics.h"

namespace kadr::kernels {
namespace {

Vec2f point(int x, int y, unsigned sample, unsigned dimension, unsigned seed = 0) {
    return make_sampler<float>(x, y, sample, seed).get_2d(dimension);
}

TEST(Sobol, UnscrambledPointsAreTheKnownOnes) {
    const double x[] = {0, 0.5, 0.25, 0.75, 0.125, 0.625, 0.375, 0.875};
    const double y[] = {0, 0.5, 0.75, 0.25, 0.625, 0.125, 0.375, 0.875};
    for (unsigned i = 0; i < 8; ++i) {
        EXPECT_EQ(to_unit_interval<float>(reverse_bits(i)), x[i]);
        EXPECT_EQ(to_unit_interval<float>(reverse_bits(pascal(i))), y[i]);
    }
}

TEST(Sobol, ReversesAllBits) {
    EXPECT_EQ(reverse_bits(1u), 0x80000000u);
    EXPECT_EQ(reverse_bits(0x12345678u), 0x1e6a2c48u);
}

/// Every box of 2^-a by 2^-(k-a) holds exactly one of the first 2^k points.
void expect_net(int k, int x, int y, unsigned dimension) {
    for (int a = 0; a <= k; ++a) {
        std::vector<int> hits(std::size_t{1} << k, 0);
        for (unsigned i = 0; i < 1u << k; ++i) {
            const Vec2f p = point(x, y, i, dimension);
            const auto column = static_cast<std::size_t>(p.x * (1 << a));
            const auto row = static_cast<std::size_t>(p.y * (1 << (k - a)));
            ++hits[(column << (k - a)) + row];
        }
        for (const int h : hits) ASSERT_EQ(h, 1) << "2^" << k << " points, split " << a << ", dimension " << dimension;
    }
}

TEST(Sobol, FillsEveryElementaryInterval) {
    for (int k = 0; k <= 10; ++k) {
        for (unsigned dimension : {0u, 1u, 7u, 123u}) expect_net(k, 5, 9, dimension);
    }
}

TEST(Sobol, StaysBelowOneAndRepeats) {
    for (unsigned i = 0; i < 20000; ++i) {
        const Vec2f p = point(3, 4, i * 7919u, i % 50);
        ASSERT_GE(std::min(p.x, p.y), 0.0f);
        ASSERT_LE(std::max(p.x, p.y), kOneMinusEpsilon);
        ASSERT_EQ(p.x, make_sampler<float>(3, 4, i * 7919u, 0).get_1d(i % 50));
    }
    EXPECT_EQ(to_unit_interval<float>(0xffffffffu), kOneMinusEpsilon);
}

/// Correlation of two sequences of uniform numbers.
template <class A, class B>
double correlation(int count, A a, B b) {
    double sum = 0.0;
    for (int i = 0; i < count; ++i) sum += (a(i) - 0.5) * (b(i) - 0.5) * 12.0;
    return sum / count;
}

TEST(Sobol, PixelsDimensionsAndSeedsAreIndependent) {
    constexpr int kCount = 1 << 14;
    const double bound = 4.0 / std::sqrt(kCount);  // 4 sigma of a mean of products with variance 1
    EXPECT_LT(std::abs(correlation(
                  kCount, [](int i) { return point(i, 0, 0, 0).x; }, [](int i) { return point(i + 1, 0, 0, 0).x; })),
              bound);
    EXPECT_LT(std::abs(correlation(
                  kCount, [](int i) { return point(i, 0, 0, 0).x; }, [](int i) { return point(i, 0, 0, 0).y; })),
              bound);
    EXPECT_LT(std::abs(correlation(
                  kCount, [](int i) { return point(i, 3, 0, 0).x; }, [](int i) { return point(i, 3, 0, 1).x; })),
              bound);
    EXPECT_LT(std::abs(correlation(
                  kCount, [](int i) { return point(1, 2, i, 3).y; }, [](int i) { return point(1, 2, i, 4).x; })),
              bound);
    EXPECT_LT(std::abs(correlation(
                  kCount, [](int i) { return point(i, 5, 1, 0, 0).x; }, [](int i) { return point(i, 5, 1, 0, 1).x; })),
              bound);
}

/// Mean squared error of an integral over the square with 64 samples, over 2000 pixels.
template <class Points>
double squared_error(Points points) {
    double sum = 0.0;
    for (int pixel = 0; pixel < 2000; ++pixel) {
        double mean = 0.0;
        for (unsigned i = 0; i < 64; ++i) {
            const Vec2f p = points(pixel, i);
            mean += (p.x + p.y < 0.8f ? 1.0 : 0.0) / 64.0;
        }
        sum += (mean - 0.32) * (mean - 0.32);
    }
    return sum / 2000.0;
}

TEST(Sobol, IntegratesAnEdgeWithAFractionOfTheVariance) {
    Random random(5);
    const double independent = squared_error([&](int, unsigned) { return random.pair(); });
    const double sobol = squared_error([](int pixel, unsigned i) { return point(pixel, 7, i, 2); });
    EXPECT_NEAR(independent, 0.32 * 0.68 / 64.0, 0.15 * 0.32 * 0.68 / 64.0);  // 4 sigma of 2000 squared errors: 13 %
    EXPECT_LT(sobol, independent / 6.0);  // theory: n^-3/2 against n^-1, a factor of 8 at 64 points, less a constant
}

/// The plane square [-1, 1]^2 in 24 x 24 bins against a uniform density on a shape.
template <class Sample, class Inside>
void expect_uniform(const char* name, double area, Sample sample, Inside inside) {
    constexpr int kBins = 24, kSteps = 32, kCount = 200000;
    std::vector<double> expected(kBins * kBins, 0.0), counts(kBins * kBins, 0.0);
    const double cell = 2.0 / (kBins * kSteps);
    for (int i = 0; i < kBins * kSteps; ++i) {
        for (int j = 0; j < kBins * kSteps; ++j) {
            if (inside((i + 0.5) * cell - 1.0, (j + 0.5) * cell - 1.0)) {
                expected[static_cast<std::size_t>(i / kSteps) * kBins + j / kSteps] += kCount * cell * cell / area;
            }
        }
    }
    Random random(9);
    for (int n = 0; n < kCount; ++n) {
        const Vec2f p = sample(random.pair());
        const int i = std::min(kBins - 1, static_cast<int>((p.x + 1.0) * 0.5 * kBins));
        const int j = std::min(kBins - 1, static_cast<int>((p.y + 1.0) * 0.5 * kBins));
        ++counts[static_cast<std::size_t>(i) * kBins + j];
    }
    EXPECT_GT(chi2_p_value(counts, expected), sidak(4)) << name;
}

TEST(Warp, DiskAndPolygonsAreUniform) {
    expect_uniform(
        "disk", M_PI, [](Vec2f u) { return sample_disk(u); }, [](double x, double y) { return x * x + y * y < 1.0; });
    for (const int corners : {3, 6, 7}) {
        const double wedge = 2.0 * M_PI / corners;
        const auto inside = [&](double x, double y) {
            for (int i = 0; i < corners; ++i) {
                const double a = (i + 0.5) * wedge;
                if (x * std::cos(a) + y * std::sin(a) > std::cos(0.5 * wedge)) return false;
            }
            return true;
        };
        expect_uniform(
            "polygon", 0.5 * corners * std::sin(wedge), [&](Vec2f u) { return sample_polygon(corners, u); }, inside);
    }
}

TEST(Warp, EndsOfTheSquareAreFinite) {
    for (const float a : {0.0f, 0.5f, kOneMinusEpsilon}) {
        for (const float b : {0.0f, 0.5f, kOneMinusEpsilon}) {
            const Vec2f d = sample_disk(Vec2f{a, b}), p = sample_polygon(5, Vec2f{a, b});
            EXPECT_LE(d.x * d.x + d.y * d.y, 1.000001f);  // two roundings of sine and cosine
            EXPECT_LE(p.x * p.x + p.y * p.y, 1.000001f);
        }
    }
}

}  // namespace
}  // namespace kadr::kernels
