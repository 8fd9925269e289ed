#include "scene/texture_limit.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/srgb.h"
#include "kernels/texture/texture.h"

namespace kadr {

namespace {

using kernels::TexelFormat;
using kernels::Vec4f;

constexpr std::size_t kChannels = 4;

bool is_srgb(TexelFormat format) { return format == TexelFormat::rgba8_srgb || format == TexelFormat::rgba16_srgb; }
bool is_wide(TexelFormat format) { return format == TexelFormat::rgba16_srgb || format == TexelFormat::rgba16_linear; }

/// How much of each old texel of a row or column the new texel `i` of `count` covers.
struct Cover {
    int first;
    std::vector<double> weights;  ///< they sum to one
};

Cover cover_of(int i, int count, int size) {
    const double width = static_cast<double>(size) / count, begin = i * width, end = begin + width;
    Cover cover{static_cast<int>(begin), {}};
    for (int at = cover.first; at < size && at < end; ++at)
        cover.weights.push_back((std::min<double>(at + 1, end) - std::max<double>(at, begin)) / width);
    return cover;
}

std::vector<Cover> covers_of(int count, int size) {
    std::vector<Cover> covers;
    for (int i = 0; i < count; ++i) covers.push_back(cover_of(i, count, size));
    return covers;
}

/// Mean of a row under each cover, R, G, B, A of each new texel.
void shrink_row(const kernels::Texture& texture, int y, const std::vector<Cover>& columns, double weight, std::vector<double>& sums) {
    for (std::size_t i = 0; i < columns.size(); ++i)
        for (std::size_t k = 0; k < columns[i].weights.size(); ++k) {
            const Vec4f texel = kernels::fetch_texel(texture, columns[i].first + static_cast<int>(k), y);
            const double w = weight * columns[i].weights[k];
            sums[kChannels * i] += w * texel.x, sums[kChannels * i + 1] += w * texel.y;
            sums[kChannels * i + 2] += w * texel.z, sums[kChannels * i + 3] += w * texel.w;
        }
}

void store(TexelFormat format, double value, std::uint8_t* texels, std::size_t index) {
    if (format == TexelFormat::rgba32f) {
        const float stored = static_cast<float>(value);
        std::memcpy(texels + index * sizeof stored, &stored, sizeof stored);
        return;
    }
    const bool alpha = index % kChannels == kChannels - 1;
    const double encoded = is_srgb(format) && !alpha ? srgb_from_linear(value) : value;
    if (is_wide(format)) {
        const auto stored = static_cast<std::uint16_t>(std::lround(65535 * encoded));
        std::memcpy(texels + index * sizeof stored, &stored, sizeof stored);
        return;
    }
    texels[index] = static_cast<std::uint8_t>(std::lround(255 * encoded));
}

}  // namespace

void limit_size(TextureData& texture, int limit_px) {
    const int longer = std::max(texture.width, texture.height);
    if (longer <= limit_px) return;
    const auto shrunk = [&](int size) { return std::max(1, static_cast<int>(std::lround(static_cast<double>(size) * limit_px / longer))); };
    const int width = shrunk(texture.width), height = shrunk(texture.height);
    if (!texture.texels.empty()) {
        const kernels::Texture before = texture.view();
        const std::size_t bytes = texture.texels.size() / (static_cast<std::size_t>(texture.width) * static_cast<std::size_t>(texture.height));
        std::vector<std::uint8_t> texels(bytes * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
        const std::vector<Cover> columns = covers_of(width, texture.width), rows = covers_of(height, texture.height);
        std::vector<double> sums(kChannels * columns.size());
        for (std::size_t y = 0; y < rows.size(); ++y) {
            std::fill(sums.begin(), sums.end(), 0.0);
            for (std::size_t k = 0; k < rows[y].weights.size(); ++k) shrink_row(before, rows[y].first + static_cast<int>(k), columns, rows[y].weights[k], sums);
            for (std::size_t i = 0; i < sums.size(); ++i) store(texture.format, sums[i], texels.data(), y * sums.size() + i);
        }
        texture.texels = std::move(texels);
    }
    texture.width = width, texture.height = height;
}

}  // namespace kadr
