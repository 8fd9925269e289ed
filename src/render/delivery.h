#pragma once

#include <atomic>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "output/encoder.h"
#include "output/image_io.h"
#include "render/bounded_queue.h"
#include "render/frame_identity.h"
#include "render/render_job.h"

namespace kadr {

/// One frame on its way to its files and into the video.
struct DeliveryItem {
    FrameReport report;              ///< `files` are those to be written, or that are there already when `reused`
    std::shared_ptr<const Image> image;  ///< linear; absent when the frame is reused
    ViewSpec view;                   ///< exposure filled in
    Metadata metadata;               ///< without "settings"
    FrameIdentity identity;
};

/// Writes frames on one thread and encodes them on another, in the order in which they were pushed, while the next
/// frames render. The video is always made from the values read back from the files, so a resumed video equals an
/// uninterrupted one by construction.
class Delivery {
public:
    Delivery(int png_bits, const std::optional<VideoPlan>& video);
    /// Not finished: writes the frames that are rendered, abandons the video.
    ~Delivery();
    Delivery(const Delivery&) = delete;
    Delivery& operator=(const Delivery&) = delete;

    /// Waits while too many frames are on their way. @throws RenderError  what writing or encoding met before
    void push(DeliveryItem item);
    /// Waits for the last frame and completes the video. @throws RenderError, Interrupted
    void finish();
    /// Frames whose files were completed since the last call; in order.
    std::vector<FrameReport> take_written();
    /// Waits for frames under way to be written; nothing more goes into the video.
    void abandon() noexcept;

    double write_s() const { return write_s_; }
    double encode_s() const { return encode_s_; }

private:
    struct Encodable {
        std::filesystem::path file;
        ViewSpec view;
    };
    void write_all();
    void write(DeliveryItem item);
    void encode_all();
    void encode(const Encodable& frame);
    void fail(std::exception_ptr error);
    void rethrow_failure();
    void join();

    const int png_bits_;
    std::unique_ptr<Encoder> encoder_;
    BoundedQueue<DeliveryItem> to_write_;
    BoundedQueue<Encodable> to_encode_;
    std::mutex mutex_;
    std::vector<FrameReport> written_;
    std::exception_ptr failure_;
    std::atomic<bool> abandoned_{false};
    std::atomic<double> write_s_{0}, encode_s_{0};
    std::thread writer_, encoding_;
};

/// The file of a frame that the video is made from: display-referred and lossless first.
const std::filesystem::path& video_source(const std::vector<std::filesystem::path>& files);

}  // namespace kadr
