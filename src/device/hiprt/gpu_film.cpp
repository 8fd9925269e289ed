#include "device/hiprt/gpu_film.h"

#include <algorithm>

namespace kadr {
namespace {

static_assert(sizeof(kernels::FilmBeauty) == sizeof(Film::Beauty) &&
                  sizeof(kernels::FilmSurface) == sizeof(Film::Surface),
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

}  // namespace

void GpuFilm::begin(Film& film) {
    film_ = &film;
    host_is_clear_ = true;
    whole_ = unread_ = false;
    weighted_ = film.weighted();
    layered_ = film.layers().any_surface();
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
    for (int h = 0; h < Film::kHalves; ++h)
        if (whole_ || h == half) fill(h, h == half);
    return y1_;
}

void GpuFilm::allocate(int first, int end, bool both) {
    y0_ = both ? 0 : first;
    y1_ = end;
    for (int i = 0; i < (both ? Film::kHalves : 1); ++i) {
        reserve(halves_[i].beauty, true);
        reserve(halves_[i].samples, true);
        reserve(halves_[i].weights, weighted_);
    }
    reserve(surface_, layered_);
}

template <class T>
void GpuFilm::reserve(DeviceBuffer<T>& buffer, bool wanted) {
    const std::size_t count = pixels(*film_, y0_, y1_);
    if (!wanted || buffer.count() >= count) return;
    buffer = {};
    buffer = DeviceBuffer<T>(memory_, count, MemoryUse::film);
}

/// The sums so far.
void GpuFilm::fill(int half, bool with_surface) {
    const Half& on_gpu = halves_[slot(half)];
    send(on_gpu.beauty, &film_->beauty(0, y0_, half));
    send(on_gpu.samples, &film_->samples(0, y0_, half));
    if (weighted_) send(on_gpu.weights, &film_->weight(0, y0_, half));
    if (layered_ && with_surface) send(surface_, &film_->surface(0, y0_));
}

template <class T, class Host>
void GpuFilm::send(const DeviceBuffer<T>& buffer, const Host* from) {
    static_assert(sizeof(T) == sizeof(Host));
    const std::size_t bytes = pixels(*film_, y0_, y1_) * sizeof(T);
    if (host_is_clear_)
        check(memory_.runtime().fill(buffer.address(), 0, bytes, stream_.handle()), "clear the film on the GPU");
    else
        uploads_.add(buffer.address(), from, bytes);
}

kernels::FilmView GpuFilm::view(int half) const {
    const Half& on_gpu = halves_[slot(half)];
    const int width = film_->width();
    return {shifted(on_gpu.beauty, width, y0_, true), shifted(on_gpu.samples, width, y0_, true),
            shifted(on_gpu.weights, width, y0_, weighted_), shifted(surface_, width, y0_, layered_)};
}

void GpuFilm::rows_done() {
    unread_ = true;
    if (!whole_) read();
}

void GpuFilm::copy_home(int half, bool with_surface) {
    const Half& on_gpu = halves_[slot(half)];
    const std::size_t count = pixels(*film_, y0_, y1_);
    downloads_.add(&film_->beauty(0, y0_, half), on_gpu.beauty.address(), count * sizeof(Film::Beauty));
    downloads_.add(&film_->samples(0, y0_, half), on_gpu.samples.address(), count * sizeof(unsigned));
    if (weighted_) downloads_.add(&film_->weight(0, y0_, half), on_gpu.weights.address(), count * sizeof(double));
    if (layered_ && with_surface)
        downloads_.add(&film_->surface(0, y0_), surface_.address(), count * sizeof(Film::Surface));
}

void GpuFilm::read() {
    if (!unread_) return;
    for (int half = 0; half < Film::kHalves; ++half)
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
    surface_ = {};
    whole_ = false;
}

}  // namespace kadr
