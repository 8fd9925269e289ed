#include "stress/sun_image.h"

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "stress/file.h"

namespace kadr::stress {

namespace {

constexpr int kWidth = 64, kHeight = 32, kSunColumn = 57, kSunRow = 7;

/// Three mantissas and their common exponent.
void add_grey(std::vector<unsigned char>& bytes, double value) {
    int exponent = 0;
    const double mantissa = std::frexp(value, &exponent);
    const auto digit = static_cast<unsigned char>(mantissa * 256);
    bytes.insert(bytes.end(), {digit, digit, digit, static_cast<unsigned char>(value > 0 ? exponent + 128 : 0)});
}

}  // namespace

double sun_solid_angle() {
    constexpr double kPi = std::numbers::pi;
    return 2 * kPi / kWidth * (std::cos(kPi * kSunRow / kHeight) - std::cos(kPi * (kSunRow + 1) / kHeight));
}

void write_sun_image(const std::filesystem::path& file, double sky, double sun) {
    const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(kHeight) + " +X " + std::to_string(kWidth) + "\n";
    std::vector<unsigned char> bytes(header.begin(), header.end());
    for (int row = 0; row < kHeight; ++row)
        for (int column = 0; column < kWidth; ++column) add_grey(bytes, row == kSunRow && column == kSunColumn ? sun : sky);
    write_file(file, bytes);
}

}  // namespace kadr::stress
