#include "render/delivery.h"

#include <algorithm>
#include <utility>

#include "output/frame_writer.h"
#include "output/view.h"
#include "render/stopwatch.h"

namespace kadr {
namespace {

// Frames between rendering, writing and encoding; each holds one image in memory.
constexpr std::size_t kFramesUnderWay = 3;

// Largest finite half float.
constexpr float kLargestHalf = 65504.0f;
constexpr int kBeautyColors = 3;

std::uint64_t count_clamped(const Image& image) {
    std::uint64_t count = 0;
    const std::size_t channels = image.channels.size();
    for (std::size_t i = 0; i < image.pixels.size(); i += channels)
        for (std::size_t c = 0; c < kBeautyColors && c < channels; ++c) count += image.pixels[i + c] > kLargestHalf;
    return count;
}

int source_rank(const std::filesystem::path& file) {
    if (is_linear_file(file)) return 2;
    return file.extension() == ".png" ? 0 : 1;
}

void add_seconds(std::atomic<double>& sum, const Stopwatch& watch) { sum = sum + watch.seconds(); }

}  // namespace

const std::filesystem::path& video_source(const std::vector<std::filesystem::path>& files) {
    return *std::min_element(files.begin(), files.end(),
                             [](const auto& a, const auto& b) { return source_rank(a) < source_rank(b); });
}

Delivery::Delivery(int png_bits, const std::optional<VideoPlan>& video)
    : png_bits_(png_bits),
      encoder_(video ? std::make_unique<Encoder>(*video) : nullptr),
      to_write_(kFramesUnderWay),
      to_encode_(kFramesUnderWay) {
    writer_ = std::thread([this] { write_all(); });
    if (encoder_) encoding_ = std::thread([this] { encode_all(); });
}

Delivery::~Delivery() { abandon(); }

void Delivery::push(DeliveryItem item) {
    rethrow_failure();
    if (!to_write_.push(std::move(item))) rethrow_failure();
}

void Delivery::finish() {
    join();
    rethrow_failure();
    if (interrupt_requested()) throw Interrupted();
    if (!encoder_) return;
    const Stopwatch watch;
    encoder_->finish();
    add_seconds(encode_s_, watch);
}

void Delivery::abandon() noexcept {
    abandoned_ = true;
    to_encode_.close();
    join();
}

void Delivery::join() {
    to_write_.close();
    if (writer_.joinable()) writer_.join();
    to_encode_.close();
    if (encoding_.joinable()) encoding_.join();
}

std::vector<FrameReport> Delivery::take_written() {
    const std::lock_guard lock(mutex_);
    return std::exchange(written_, {});
}

void Delivery::fail(std::exception_ptr error) {
    {
        const std::lock_guard lock(mutex_);
        if (!failure_) failure_ = std::move(error);
    }
    abandoned_ = true;
    to_write_.close();
    to_encode_.close();
}

void Delivery::rethrow_failure() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(failure_);
}

void Delivery::write_all() {
    try {
        while (std::optional<DeliveryItem> item = to_write_.pop()) write(std::move(*item));
    } catch (...) {
        fail(std::current_exception());
    }
}

void Delivery::write(DeliveryItem item) {
    const Stopwatch watch;
    if (item.image) {
        for (const std::filesystem::path& file : item.report.files) {
            const bool linear = is_linear_file(file);
            if (linear) item.report.clamped = count_clamped(*item.image);
            item.metadata["settings"] = item.identity.of(linear);
            write_frame(file, *item.image, item.view, png_bits_, item.metadata);
        }
        add_seconds(write_s_, watch);
    }
    Encodable encodable{video_source(item.report.files), item.view};
    {
        const std::lock_guard lock(mutex_);
        written_.push_back(std::move(item.report));
    }
    if (encoder_ && !abandoned_) to_encode_.push(std::move(encodable));
}

void Delivery::encode_all() {
    try {
        while (std::optional<Encodable> frame = to_encode_.pop()) {
            if (!abandoned_ && !interrupt_requested()) encode(*frame);
        }
    } catch (...) {
        fail(std::current_exception());
    }
}

void Delivery::encode(const Encodable& frame) {
    const Stopwatch watch;
    const Image stored = image_io().read(frame.file);
    encoder_->push(is_linear_file(frame.file) ? apply_view(stored, frame.view, false) : stored);
    add_seconds(encode_s_, watch);
}

}  // namespace kadr
