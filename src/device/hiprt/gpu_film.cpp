#include "device/hiprt/gpu_film.h"

namespace kadr {
namespace {

static_assert(sizeof(kernels::FilmBeauty) == sizeof(Film::Beauty) &&
                  sizeof(kernels::FilmSurface) == sizeof(Film::Surface),
              "the sums of the kernels are those of the film");

void add(const kernels::FilmBeauty& from, Film::Beauty& to) {
    to.r += from.r;
    to.g += from.g;
    to.b += from.b;
    to.alpha += from.alpha;
}

void add(const kernels::FilmSurface& from, Film::Surface& to) {
    for (int c = 0; c < 3; ++c) {
        to.albedo[c] += from.albedo[c];
        to.normal[c] += from.normal[c];
    }
    to.depth += from.depth;
    to.depth_weight += from.depth_weight;
    for (int c = 0; c < 2; ++c) to.motion[c] += from.motion[c];
}

/// An array of rows from `y0` on, addressed as if it began with the first row of the image.
template <class T>
T* shifted(const DeviceBuffer<T>& buffer, int width, int y0, bool wanted) {
    if (!wanted) return nullptr;
    return reinterpret_cast<T*>(buffer.address() -
                                static_cast<std::size_t>(width) * static_cast<std::size_t>(y0) * sizeof(T));
}

}  // namespace

template <class T>
void GpuFilm::take(DeviceBuffer<T>& buffer, bool wanted) {
    if (!wanted) return;
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(y1_ - y0_);
    if (buffer.count() < count) {
        buffer = {};
        buffer = DeviceBuffer<T>(memory_, count, MemoryUse::film);
    }
    check(memory_.runtime().fill(buffer.address(), 0, count * sizeof(T), stream_.handle()),
          "clear the film on the GPU");
}

void GpuFilm::begin(const Film& film, int y0, int y1) {
    width_ = film.width();
    y0_ = y0;
    y1_ = y1;
    weighted_ = film.weighted();
    layered_ = film.layers().any_surface();
    take(beauty_, true);
    take(samples_, true);
    take(weights_, weighted_);
    take(surface_, layered_);
}

kernels::FilmView GpuFilm::view() const {
    return {shifted(beauty_, width_, y0_, true), shifted(samples_, width_, y0_, true),
            shifted(weights_, width_, y0_, weighted_), shifted(surface_, width_, y0_, layered_)};
}

template <class T>
const T* GpuFilm::read_back(const DeviceBuffer<T>& buffer, std::size_t& offset) {
    const std::size_t bytes = static_cast<std::size_t>(width_) * static_cast<std::size_t>(y1_ - y0_) * sizeof(T);
    std::byte* to = pinned_.data() + offset;
    offset += bytes;
    check(memory_.runtime().download(to, buffer.address(), bytes, stream_.handle()), "read the film back from the GPU");
    return reinterpret_cast<const T*>(to);
}

void GpuFilm::add_to(Film& film, int half) {
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(y1_ - y0_);
    const std::size_t bytes =
        count * (sizeof(kernels::FilmBeauty) + sizeof(unsigned) + sizeof(double) + sizeof(kernels::FilmSurface));
    if (pinned_.bytes() < bytes) {
        pinned_ = {};
        pinned_ = PinnedMemory(memory_.runtime(), bytes);
    }
    std::size_t offset = 0;
    const kernels::FilmBeauty* beauty = read_back(beauty_, offset);
    const unsigned* samples = read_back(samples_, offset);
    const double* weights = weighted_ ? read_back(weights_, offset) : nullptr;
    const kernels::FilmSurface* surface = layered_ ? read_back(surface_, offset) : nullptr;
    stream_.synchronize("render on the GPU");
    std::size_t i = 0;
    for (int y = y0_; y < y1_; ++y)
        for (int x = 0; x < width_; ++x, ++i) {
            add(beauty[i], film.beauty(x, y, half));
            film.samples(x, y, half) += samples[i];
            if (weights) film.weight(x, y, half) += weights[i];
            if (surface) add(surface[i], film.surface(x, y));
        }
}

bool GpuFilm::give_back() {
    if (beauty_.count() == 0) return false;
    beauty_ = {};
    samples_ = {};
    weights_ = {};
    surface_ = {};
    return true;
}

}  // namespace kadr
