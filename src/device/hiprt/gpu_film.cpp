#include "device/hiprt/gpu_film.h"

#include <algorithm>

namespace kadr {
namespace {

static_assert(sizeof(kernels::FilmBeauty) == sizeof(Film::Beauty) && sizeof(kernels::FilmVector) == sizeof(Film::Vector) &&
                  sizeof(kernels::FilmMotion) == sizeof(Film::Pair),
              "the sums of the kernels are those of the film, and are copied as they are");

/// An array of rows from `y0` on, addressed as if it began with the first row of the image.
template <class T>
T* shifted(const DeviceBuffer<T>& buffer, int width, int y0, bool wanted) {
    if (!wanted) return nullptr;
    return reinterpret_cast<T*>(buffer.address() -
                                static_cast<std::size_t>(width) * static_cast<std::size_t>(y0) * sizeof(T));
}

std::size_t pixels(const Film& film, int y0, int y1) {
    return static_cast<std::size_t>(film.width()) * static_cast<std::size_t>(y1 - y0);
}

/// Applies `visit(from, to)` to the rows of [y0, y1) that lie in one piece at home.
template <class Visit>
void for_each_band(const Film& film, int y0, int y1, const Visit& visit) {
    for (int from = y0, to; from < y1; from = to) visit(from, to = std::min(y1, film.end_of_band(from)));
}

}  // namespace

void GpuFilm::begin(Film& film) {
    film_ = &film;
    host_is_clear_ = true;
    whole_ = unread_ = false;
    weighted_ = film.weighted();
    layers_ = film.layers();
}

/// A film that begin() did not announce has the sums that it has.
void GpuFilm::look_at(Film& film) {
    if (film_ == &film) return;
    read();
    begin(film);
    host_is_clear_ = false;
}

int GpuFilm::take_rows(Film& film, int half, int first) {
    look_at(film);
    if (whole_) return film.height();
    while (true) {
        const int end =
            whole_fits_ ? film.height() : std::min(film.height(), first + std::min(most_rows_, film.height()));
        try {
            allocate(first, end, whole_fits_);
            break;
        } catch (const GpuOutOfMemory&) {
            free_all();
            memory_.note_step("the film comes in parts");
            if (whole_fits_)
                whole_fits_ = false;
            else if (end - first == 1)
                throw;
            else
                most_rows_ = (end - first + 1) / 2;
        }
    }
    whole_ = whole_fits_;
    half_ = half;
    for (int h = 0; h < film_->halves(); ++h)
        if (whole_ || h == half) fill(h, h == half);
    return y1_;
}

void GpuFilm::allocate(int first, int end, bool both) {
    y0_ = both ? 0 : first;
    y1_ = end;
    for (int i = 0; i < (both ? film_->halves() : 1); ++i) {
        reserve(halves_[i].beauty, true);
        reserve(halves_[i].samples, true);
        reserve(halves_[i].weights, weighted_);
    }
    visit_surface([&](auto& buffer, bool wanted, const auto&) { reserve(buffer, wanted); });
}

template <class T>
void GpuFilm::reserve(DeviceBuffer<T>& buffer, bool wanted) {
    const std::size_t count = pixels(*film_, y0_, y1_);
    if (!wanted || buffer.count() >= count) return;
    buffer = {};
    buffer = DeviceBuffer<T>(memory_, count, MemoryUse::film);
}

/// Applies `visit(buffer, wanted, first sum of a row at home)` to the sums of every layer.
template <class Visit>
void GpuFilm::visit_surface(const Visit& visit) {
    visit(albedo_, layers_.albedo, [&](int y) { return &film_->albedo(0, y); });
    visit(normal_, layers_.normal, [&](int y) { return &film_->normal(0, y); });
    visit(depth_, layers_.depth, [&](int y) { return &film_->depth(0, y); });
    visit(hits_, keeps_hits(), [&](int y) { return &film_->hits(0, y); });
    visit(motion_, layers_.motion, [&](int y) { return &film_->motion(0, y); });
}

/// The sums so far.
void GpuFilm::fill(int half, bool with_surface) {
    const Half& on_gpu = halves_[slot(half)];
    send(on_gpu.beauty, true, [&](int y) { return &film_->beauty(0, y, half); });
    send(on_gpu.samples, true, [&](int y) { return &film_->samples(0, y, half); });
    send(on_gpu.weights, weighted_, [&](int y) { return &film_->weight(0, y, half); });
    if (with_surface)
        visit_surface([&](const auto& buffer, bool wanted, const auto& host_at) { send(buffer, wanted, host_at); });
}

/// @param host_at  from a row to its first sum at home
template <class T, class HostAt>
void GpuFilm::send(const DeviceBuffer<T>& buffer, bool wanted, const HostAt& host_at) {
    if (!wanted) return;
    static_assert(sizeof(T) == sizeof(*host_at(0)));
    if (host_is_clear_)
        check(memory_.runtime().fill(buffer.address(), 0, pixels(*film_, y0_, y1_) * sizeof(T), stream_.handle()),
              "clear the film on the GPU");
    else
        for_each_band(*film_, y0_, y1_, [&](int from, int to) {
            uploads_.add(buffer.address() + pixels(*film_, y0_, from) * sizeof(T), host_at(from),
                         pixels(*film_, from, to) * sizeof(T));
        });
}

kernels::FilmView GpuFilm::view(int half) const {
    const Half& on_gpu = halves_[slot(half)];
    const auto at = [&](const auto& buffer, bool wanted) { return shifted(buffer, film_->width(), y0_, wanted); };
    return {at(on_gpu.beauty, true),
            at(on_gpu.samples, true),
            at(on_gpu.weights, weighted_),
            at(albedo_, layers_.albedo),
            at(normal_, layers_.normal),
            at(depth_, layers_.depth),
            at(hits_, keeps_hits()),
            at(motion_, layers_.motion)};
}

void GpuFilm::rows_done() {
    unread_ = true;
    if (!whole_) read();
}

void GpuFilm::copy_home(int half, bool with_surface) {
    const Half& on_gpu = halves_[slot(half)];
    bring(on_gpu.beauty, true, [&](int y) { return &film_->beauty(0, y, half); });
    bring(on_gpu.samples, true, [&](int y) { return &film_->samples(0, y, half); });
    bring(on_gpu.weights, weighted_, [&](int y) { return &film_->weight(0, y, half); });
    if (with_surface)
        visit_surface([&](const auto& buffer, bool wanted, const auto& host_at) { bring(buffer, wanted, host_at); });
}

template <class T, class HostAt>
void GpuFilm::bring(const DeviceBuffer<T>& buffer, bool wanted, const HostAt& host_at) {
    if (!wanted) return;
    for_each_band(*film_, y0_, y1_, [&](int from, int to) {
        downloads_.add(host_at(from), buffer.address() + pixels(*film_, y0_, from) * sizeof(T),
                       pixels(*film_, from, to) * sizeof(T));
    });
}

void GpuFilm::read() {
    if (!unread_) return;
    for (int half = 0; half < film_->halves(); ++half)
        if (whole_ || half == half_) copy_home(half, half == half_);
    downloads_.finish();
    unread_ = false;
    host_is_clear_ = false;
}

bool GpuFilm::give_back() {
    if (halves_[0].beauty.count() == 0) return false;
    read();
    free_all();
    return true;
}

void GpuFilm::free_all() {
    for (Half& half : halves_) half = {};
    visit_surface([](auto& buffer, bool, const auto&) { buffer = {}; });
    whole_ = false;
}

}  // namespace kadr
