#include "measure/z_test.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kadr {
namespace {

constexpr std::size_t kChannels = 3;
constexpr std::array<const char*, ReplicateSums::kScales> kNames{"pixels", "tiles", "picture"};

int cells(int pixels, int side) { return (pixels + side - 1) / side; }

/// Means of R, G, B over the cells of a grid. @return [y][x][channel]
std::vector<double> cell_means(const Image& image, int side) {
    const int columns = cells(image.width, side), rows = cells(image.height, side);
    std::vector<double> sums(static_cast<std::size_t>(columns * rows) * kChannels);
    std::vector<int> counts(static_cast<std::size_t>(columns * rows));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const std::size_t cell = static_cast<std::size_t>(y / side * columns + x / side);
            const float* pixel = &image.pixels[static_cast<std::size_t>(y * image.width + x) * image.channels.size()];
            ++counts[cell];
            for (std::size_t c = 0; c < kChannels; ++c) sums[cell * kChannels + c] += pixel[c];
        }
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] /= counts[i / kChannels];
    return sums;
}

double two_sided_p(double z) { return std::erfc(std::abs(z) / std::sqrt(2.0)); }

/// Student's number that is as unlikely as a normal one: normal_of_student the other way round.
double student_of_normal(double z, double degrees) {
    const double u = z * (8 * degrees + 3) / (8 * degrees + 1);
    return std::sqrt(degrees * std::expm1(u * u / degrees));
}

struct Welch {
    double difference = 0, error = 0, degrees = 1;
    double z() const {
        if (!std::isfinite(difference)) return std::numeric_limits<double>::infinity();
        return error > 0 ? normal_of_student(difference / error, degrees) : 0;
    }
};

/// @param floor  variance of either mean that the replicates may not show
Welch welch(const Moments& a, const Moments& b, double floor) {
    Welch w;
    w.difference = b.mean - a.mean;
    const double va = a.variance_of_mean() + floor, vb = b.variance_of_mean() + floor;
    w.error = std::sqrt(va + vb);
    const double na = static_cast<double>(a.count) - 1, nb = static_cast<double>(b.count) - 1;
    if (va + vb > 0) w.degrees = (va + vb) * (va + vb) / (va * va / na + vb * vb / nb);
    return w;
}

double squared(double x) { return x * x; }

/// How much the means of a pixel's neighbourhood span: what one sample that falls on the other side of an edge adds.
double contrast_at(const ReplicateSums::Scale& a, const ReplicateSums::Scale& b, int x, int y, std::size_t channel) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (int v = std::max(y - 1, 0); v <= std::min(y + 1, a.height - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, a.width - 1); ++u)
            for (const ReplicateSums::Scale* scale : {&a, &b}) {
                const double mean = scale->values[static_cast<std::size_t>(v * a.width + u) * kChannels + channel].mean;
                low = std::min(low, mean);
                high = std::max(high, mean);
            }
    return high - low;
}

/// Variance of a mean beneath what replicates show: a few of them may well agree on a count of samples by chance, and a
/// pixel that one sample more or less would change is no finer than half of that.
double quantum(const ReplicateSums::Scale& a, const ReplicateSums::Scale& b, int x, int y, std::size_t channel,
               int samples, std::size_t replicates) {
    return squared(0.5 * contrast_at(a, b, x, y, channel) / samples) / static_cast<double>(replicates);
}

/// Holm's procedure. @param p  of all tests; sorted here  @return how many are rejected
std::size_t count_rejected(std::vector<double>& p, double level) {
    std::sort(p.begin(), p.end());
    std::size_t rejected = 0;
    while (rejected < p.size() && p[rejected] <= level / static_cast<double>(p.size() - rejected)) ++rejected;
    return rejected;
}

/// The tests of one scale. @param z  [y][x] the largest of the channels, where it is asked for
ScaleResult compare_scale(const ReplicateSums& first, const ReplicateSums& second, int number, int samples,
                          std::vector<float>* z_map) {
    const ReplicateSums::Scale &a = first.scale(number), &b = second.scale(number);
    ScaleResult result;
    result.name = kNames[static_cast<std::size_t>(number)];
    std::vector<double> p;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            double extreme = 0;
            for (std::size_t c = 0; c < kChannels; ++c) {
                const std::size_t i = static_cast<std::size_t>(y * a.width + x) * kChannels + c;
                const Moments &ma = a.values[i], &mb = b.values[i];
                double floor = squared(kArithmetic * std::max(std::abs(ma.mean), std::abs(mb.mean))) / 2;
                if (number == 0) floor += quantum(a, b, x, y, c, samples, std::min(ma.count, mb.count));
                const double z = welch(ma, mb, floor).z();
                p.push_back(two_sided_p(z));
                if (std::abs(z) > std::abs(extreme)) extreme = z;
                if (std::abs(z) > std::abs(result.largest_z)) {
                    result.largest_z = z;
                    result.x = x, result.y = y, result.channel = static_cast<int>(c);
                }
                if (ma.variance() + mb.variance() == 0) continue;
                ++result.tests;
                for (int k = 0; k < ScaleResult::kBounds; ++k)
                    result.beyond[static_cast<std::size_t>(k)] += std::abs(z) > k + 2 ? 1 : 0;
            }
            if (z_map) z_map->push_back(static_cast<float>(extreme));
        }
    for (double& share : result.beyond) share /= static_cast<double>(std::max<std::size_t>(result.tests, 1));
    result.rejected = count_rejected(p, kLevel / ReplicateSums::kScales);
    result.smallest_p = std::min(1.0, p.front() * static_cast<double>(p.size()));
    return result;
}

}  // namespace

void Moments::add(double value) {
    ++count;
    const double before = value - mean;
    mean += before / static_cast<double>(count);
    squares += before * (value - mean);
}

void ReplicateSums::add(const Image& image) {
    const int sides[kScales] = {1, kTile, std::max(image.width, image.height)};
    for (std::size_t i = 0; i < kScales; ++i) {
        const std::vector<double> means = cell_means(image, sides[i]);
        scales_[i].width = cells(image.width, sides[i]);
        scales_[i].height = cells(image.height, sides[i]);
        scales_[i].values.resize(means.size());
        for (std::size_t k = 0; k < means.size(); ++k) scales_[i].values[k].add(means[k]);
    }
    ++count_;
}

Image ReplicateSums::mean() const {
    const Scale& pixels = scales_[0];
    Image image{pixels.width, pixels.height, {"R", "G", "B"}, {}};
    for (const Moments& value : pixels.values) image.pixels.push_back(static_cast<float>(value.mean));
    return image;
}

bool ZTest::differs() const {
    return std::any_of(scales.begin(), scales.end(), [](const ScaleResult& scale) { return scale.rejected > 0; });
}

double normal_of_student(double t, double degrees) {
    const double size = (8 * degrees + 1) / (8 * degrees + 3) * std::sqrt(degrees * std::log1p(t * t / degrees));
    return std::copysign(size, t);
}

ZTest compare_replicates(const ReplicateSums& first, const ReplicateSums& second, int samples) {
    ZTest test;
    for (int i = 0; i < ReplicateSums::kScales; ++i)
        test.scales[static_cast<std::size_t>(i)] = compare_scale(first, second, i, samples, i == 0 ? &test.z : nullptr);
    // Of the picture's brightness. Channels share most of a replicate's noise, so their errors are added.
    const auto& a = first.scale(ReplicateSums::kScales - 1).values;
    const auto& b = second.scale(ReplicateSums::kScales - 1).values;
    for (std::size_t c = 0; c < kChannels; ++c) {
        test.mean[0] += a[c].mean / kChannels;
        test.mean[1] += b[c].mean / kChannels;
    }
    if (!(test.mean[0] > 0)) return test;
    double error = 0, degrees = 1;
    for (std::size_t c = 0; c < kChannels; ++c) {
        const Welch w = welch(a[c], b[c], 0);
        error += w.error / kChannels;
        degrees = c == 0 ? w.degrees : std::min(degrees, w.degrees);
    }
    const double reach = student_of_normal(1.959964, degrees) * error / test.mean[0];
    test.difference = test.mean[1] / test.mean[0] - 1;
    test.difference_from = test.difference - reach;
    test.difference_to = test.difference + reach;
    return test;
}

}  // namespace kadr
