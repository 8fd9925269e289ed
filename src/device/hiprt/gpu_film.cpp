#include "device/hiprt/gpu_film.h"

namespace kadr {
namespace {

static_assert(sizeof(kernels::FilmBeauty) == sizeof(Film::Beauty), "the sums of the kernels are those of the film");

void add(const kernels::FilmBeauty& from, Film::Beauty& to) {
    to.r += from.r;
    to.g += from.g;
    to.b += from.b;
    to.alpha += from.alpha;
}

void set(double (&to)[3], const kernels::FilmVector& from) { to[0] = from.x, to[1] = from.y, to[2] = from.z; }

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
    layers_ = film.layers();
    take(beauty_, true);
    take(samples_, true);
    take(weights_, weighted_);
    take(albedo_, layers_.albedo);
    take(normal_, layers_.normal);
    take(depth_, layers_.depth);
    take(hits_, keeps_hits());
    take(motion_, layers_.motion);
}

kernels::FilmView GpuFilm::view() const {
    const auto at = [&](const auto& buffer, bool wanted) { return shifted(buffer, width_, y0_, wanted); };
    return {at(beauty_, true),
            at(samples_, true),
            at(weights_, weighted_),
            at(albedo_, layers_.albedo),
            at(normal_, layers_.normal),
            at(depth_, layers_.depth),
            at(hits_, keeps_hits()),
            at(motion_, layers_.motion)};
}

template <class T>
const T* GpuFilm::read_back(const DeviceBuffer<T>& buffer, bool wanted, std::size_t& offset) {
    if (!wanted) return nullptr;
    const std::size_t bytes = static_cast<std::size_t>(width_) * static_cast<std::size_t>(y1_ - y0_) * sizeof(T);
    std::byte* to = pinned_.data() + offset;
    offset += bytes;
    check(memory_.runtime().download(to, buffer.address(), bytes, stream_.handle()), "read the film back from the GPU");
    return reinterpret_cast<const T*>(to);
}

void GpuFilm::add_to(Film& film, int half) {
    const std::size_t count = static_cast<std::size_t>(width_) * static_cast<std::size_t>(y1_ - y0_);
    const std::size_t bytes = count * Film::bytes_per_pixel(layers_, 1, weighted_);
    if (pinned_.bytes() < bytes) {
        pinned_ = {};
        pinned_ = PinnedMemory(memory_.runtime(), bytes);
    }
    std::size_t offset = 0;
    // By their alignment: those of 8 bytes before those of 4.
    const kernels::FilmBeauty* beauty = read_back(beauty_, true, offset);
    const double* weights = read_back(weights_, weighted_, offset);
    const kernels::FilmVector* albedo = read_back(albedo_, layers_.albedo, offset);
    const kernels::FilmVector* normal = read_back(normal_, layers_.normal, offset);
    const double* depth = read_back(depth_, layers_.depth, offset);
    const double* hits = read_back(hits_, keeps_hits(), offset);
    const kernels::FilmMotion* motion = read_back(motion_, layers_.motion, offset);
    const unsigned* samples = read_back(samples_, true, offset);
    stream_.synchronize("render on the GPU");
    std::size_t i = 0;
    for (int y = y0_; y < y1_; ++y)
        for (int x = 0; x < width_; ++x, ++i) {
            add(beauty[i], film.beauty(x, y, half));
            film.samples(x, y, half) += samples[i];
            if (weights) film.weight(x, y, half) += weights[i];
            if (!layers_.any_surface()) continue;
            Film::Surface surface;
            if (albedo) set(surface.albedo, albedo[i]);
            if (normal) set(surface.normal, normal[i]);
            if (depth) surface.depth = depth[i];
            if (hits) surface.depth_weight = hits[i];
            if (motion) surface.motion[0] = motion[i].x, surface.motion[1] = motion[i].y;
            film.add_surface(x, y, surface);
        }
}

bool GpuFilm::give_back() {
    if (beauty_.count() == 0) return false;
    beauty_ = {};
    samples_ = {};
    weights_ = {};
    albedo_ = {};
    normal_ = {};
    depth_ = {};
    hits_ = {};
    motion_ = {};
    return true;
}

}  // namespace kadr
