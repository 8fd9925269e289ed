// kadr_replay SHOT [FRAME] [SAMPLES] [ROUNDS]: how much of a frame's CPU time is Embree's.
//
// Renders the frame once while recording every ray, then alternates between rendering it without recording and sending
// the same rays, in the same order and packets, through Embree alone; one thread. Prints the medians of CPU seconds and
// their ratio.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "device/embree/embree_device.h"
#include "device/embree/embree_scene.h"
#include "device/embree/kernel_sets.h"
#include "device/embree/tile_job.h"
#include "frame/snapshot.h"
#include "kernels/camera/filter_table.h"
#include "shot/shot_parser.h"

namespace kadr {
namespace {

double cpu_seconds() {
    timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

/// One frame, tile by tile, on this thread.
class Frame {
public:
    Frame(const EmbreeScene& scene, int samples)
        : scene_(scene), samples_(samples), result_(std::make_unique<TileResult>()) {
        const kernels::Settings& settings = scene.view().settings;
        kernels::build_filter(settings.filter, settings.filter_radius, filter_);
        const unsigned set = compiled_set(settings.integrator, scene.requirements());
        driver_ = make_tile_driver(best_width(), settings.integrator, set);
    }

    double render(std::vector<LoggedRay>* log) {
        const kernels::Settings& settings = scene_.view().settings;
        TileJob job;
        job.scene = &scene_.view();
        job.flat = scene_.flat();
        job.instanced = scene_.instanced();
        job.filter = &filter_;
        job.shutter = &shutter_;
        if (log) {
            job.log = [](void* user, const LoggedRay& ray) {
                static_cast<std::vector<LoggedRay>*>(user)->push_back(ray);
            };
            job.log_user = log;
        }
        const double begin = cpu_seconds();
        for (job.y0 = 0; job.y0 < settings.height; job.y0 += kTileEdge)
            for (job.x0 = 0; job.x0 < settings.width; job.x0 += kTileEdge)
                for (job.first_sample = 0; job.first_sample < samples_; job.first_sample += kSamplesPerBatch) {
                    job.x1 = std::min(job.x0 + kTileEdge, settings.width);
                    job.y1 = std::min(job.y0 + kTileEdge, settings.height);
                    job.sample_count = std::min(kSamplesPerBatch, samples_ - job.first_sample);
                    driver_->render(job, *result_, counters_);
                }
        return cpu_seconds() - begin;
    }

private:
    const EmbreeScene& scene_;
    int samples_;
    std::unique_ptr<TileResult> result_;
    std::unique_ptr<TileDriver> driver_;
    kernels::FilterTable filter_{};
    kernels::Shutter shutter_;
    TileCounters counters_;
};

template <class Ray>
void fill(Ray& ray, const LoggedRay& from) {
    ray.org_x = from.origin[0], ray.org_y = from.origin[1], ray.org_z = from.origin[2];
    ray.dir_x = from.direction[0], ray.dir_y = from.direction[1], ray.dir_z = from.direction[2];
    ray.tnear = 0, ray.tfar = from.distance, ray.time = from.time;
    ray.mask = 0xffffffffu, ray.id = 0, ray.flags = 0;
}

void fill_lane(RTCRay8& ray, int i, const LoggedRay& from) {
    ray.org_x[i] = from.origin[0], ray.org_y[i] = from.origin[1], ray.org_z[i] = from.origin[2];
    ray.dir_x[i] = from.direction[0], ray.dir_y[i] = from.direction[1], ray.dir_z[i] = from.direction[2];
    ray.tnear[i] = 0, ray.tfar[i] = from.distance, ray.time[i] = from.time;
    ray.mask[i] = 0xffffffffu, ray.id[i] = static_cast<unsigned>(i), ray.flags[i] = 0;
}

/// Sends rays [at, at + count) as one packet.
void replay_packet(RTCScene target, const LoggedRay* rays, int count, QueryContext& context) {
    alignas(32) int valid[8];
    for (int i = 0; i < 8; ++i) valid[i] = i < count ? -1 : 0;
    if (rays->shadow) {
        alignas(32) RTCRay8 ray;
        for (int i = 0; i < 8; ++i) fill_lane(ray, i, rays[std::min(i, count - 1)]);
        occluded8(valid, target, context, ray);
        return;
    }
    alignas(32) RTCRayHit8 ray;
    for (int i = 0; i < 8; ++i) {
        fill_lane(ray.ray, i, rays[std::min(i, count - 1)]);
        ray.hit.geomID[i] = ray.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
    }
    intersect8(valid, target, context, ray, rays->camera);
}

void replay_single(RTCScene target, const LoggedRay& logged, QueryContext& context) {
    if (logged.shadow) {
        RTCRay ray;
        fill(ray, logged);
        occluded1(target, context, ray);
        return;
    }
    RTCRayHit ray;
    fill(ray.ray, logged);
    ray.hit.geomID = ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect1(target, context, ray, logged.camera);
}

double replay(const EmbreeScene& scene, const std::vector<LoggedRay>& rays) {
    QueryContext context;
    const double begin = cpu_seconds();
    for (std::size_t i = 0; i < rays.size();) {
        const LoggedRay& ray = rays[i];
        const RTCScene target = ray.flat ? scene.flat() : scene.instanced();
        context.shadow = ray.shadow;
        if (ray.packet > 1)
            replay_packet(target, &ray, ray.packet, context);
        else
            replay_single(target, ray, context);
        i += ray.packet;
    }
    return cpu_seconds() - begin;
}

int run(int argc, char** argv) {
    if (argc < 2) {
        std::fputs("usage: kadr_replay SHOT [FRAME] [SAMPLES] [ROUNDS]\n", stderr);
        return 2;
    }
    const Shot shot = parse_shot(argv[1]);
    std::vector<SceneFileRequest> requests;
    for (const SceneSpec& spec : shot.scenes) requests.push_back({spec.id, spec.gltf, spec.where});
    const Scene scene = load_scene(requests);
    const BoundShot bound(shot, scene);
    const int frame = argc > 2 ? std::atoi(argv[2]) : bound.timing().frames.front();
    const int samples = argc > 3 ? std::atoi(argv[3]) : 4;
    const int rounds = argc > 4 ? std::atoi(argv[4]) : 5;
    const std::vector<SceneSnapshot> snapshots = make_snapshots(bound, bound.sequence().frame(frame));

    const EmbreeDeviceHandle device(rtcNewDevice("threads=1"));
    EmbreeScene embree(device.get(), scene, nullptr);
    embree.set_frame(snapshots.front());
    Frame renderer(embree, samples);
    std::vector<LoggedRay> rays;
    renderer.render(&rays);
    std::vector<double> total, traced, ratio;
    for (int r = 0; r < rounds; ++r) {
        total.push_back(renderer.render(nullptr));
        traced.push_back(replay(embree, rays));
        ratio.push_back(total.back() / traced.back());
    }
    const kernels::Settings& settings = embree.view().settings;
    const double pixel_samples = static_cast<double>(settings.width) * settings.height * samples;
    std::printf(
        "{\"rays\": %zu, \"rays_per_sample\": %.2f, \"render_cpu_s\": %.3f, \"embree_cpu_s\": %.3f, \"ratio\": %.3f, "
        "\"msamples_cpu_s\": %.3f}\n",
        rays.size(), static_cast<double>(rays.size()) / pixel_samples, median(total), median(traced), median(ratio),
        pixel_samples / median(total) / 1e6);
    return 0;
}

}  // namespace
}  // namespace kadr

int main(int argc, char** argv) {
    try {
        return kadr::run(argc, argv);
    } catch (const kadr::InputError& error) {
        for (const kadr::Diagnostic& diagnostic : error.diagnostics())
            std::fprintf(stderr, "%s\n", diagnostic.text().c_str());
        return 2;
    }
}
