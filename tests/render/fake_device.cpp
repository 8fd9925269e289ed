#include "render/fake_device.h"

#include <mutex>

namespace kadr {
namespace {

std::mutex g_mutex;  ///< devices share the script

/// A gradient that differs from frame to frame and, a little, from seed to seed.
class FakeDevice : public Device {
public:
    explicit FakeDevice(int number = 0) : number_(number) {}
    std::string name() const override { return number_ == 0 ? "fake (no lanes, 1 threads)" : "other (no lanes, 1 threads)"; }
    void load(const Scene&, const Image*, const BuildSettings& build) override { fake_device().build = build; }
    void set_frame(const SceneSnapshot& snapshot) override {
        {
            const std::lock_guard lock(g_mutex);
            ++fake_device().set_frames;
            fake_device().staged += staged_.get() == &snapshot;
        }
        staged_.reset();
        frame_ = snapshot.frame_number;
        seed_ = snapshot.settings.seed;
        statistics_ = {};
    }
    void render(const Pass& pass, Film& film) override {
        FakeDeviceScript& script = fake_device();
        if (pass.half == 0) {
            const int number = render_number();
            if (script.before_render) script.before_render(number);
            if (script.on_frame) script.on_frame(number_, frame_);
        }
        note(pass);
        if (pass.idle) pass.idle();
        for (int y = 0; y < film.height(); ++y)
            for (int x = 0; x < film.width(); ++x) add(film, x, y, pass, script.scale, script.noise);
        statistics_.pixel_samples += static_cast<std::uint64_t>(film.width()) * film.height() * pass.sample_count;
        if (pass.progress) pass.progress(1);
    }
    DeviceStatistics statistics() const override { return statistics_; }
    void stage(const std::shared_ptr<const SceneSnapshot>& next) override { staged_ = next; }

private:
    static int render_number() {
        const std::lock_guard lock(g_mutex);
        return fake_device().renders++;
    }
    static void note(const Pass& pass) {
        const std::lock_guard lock(g_mutex);
        fake_device().passes.push_back(pass);
    }
    void add(Film& film, int x, int y, const Pass& pass, float scale, float noise) const {
        const int count = pass.sample_count, half = pass.half;
        if (pass.active && pass.active[static_cast<std::size_t>(y * film.width() + x)] == 0) return;
        const float value = scale * static_cast<float>(x + y + frame_ + 0.01 * seed_) / 64.0f + (half == 0 ? noise : -noise) * static_cast<float>(frame_ + 1);
        Film::Beauty& beauty = film.beauty(x, y, half);
        beauty.r += count * value;
        beauty.g += count * value * 0.5f;
        beauty.b += count * 0.25f * scale;
        beauty.alpha += static_cast<float>(count);
        film.samples(x, y, half) += count;
        if (film.weighted()) film.weight(x, y, half) += static_cast<float>(count);
    }
    int number_ = 0, frame_ = 0;
    std::shared_ptr<const SceneSnapshot> staged_;
    unsigned seed_ = 0;
    DeviceStatistics statistics_;
};

}  // namespace

FakeDeviceScript& fake_device() {
    static FakeDeviceScript script;
    return script;
}

DeviceChoice make_device(const DeviceRequest&) { return {std::make_unique<FakeDevice>(), "a test asked for it", ""}; }
std::vector<DeviceChoice> make_devices(const DeviceRequest& request) {
    std::vector<DeviceChoice> devices;
    for (int i = 0; i < fake_device().devices; ++i) devices.push_back({std::make_unique<FakeDevice>(i), make_device(request).why, ""});
    return devices;
}
std::vector<DeviceReport> list_devices() { return {{"fake", "nothing", true, ""}}; }

}  // namespace kadr
