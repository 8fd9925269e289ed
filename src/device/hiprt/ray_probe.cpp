#include "device/hiprt/ray_probe.h"

#include <algorithm>

#include "device/tables/scene_probe.h"

namespace kadr {

void RayProbe::launch(const Frame& frame, const kernels::ProbeParams& params) {
    const LaunchSize size{(params.count + kernels::kProbeBlock - 1) / kernels::kProbeBlock, 1, kernels::kProbeBlock, 1};
    kernels::ProbeParams argument = params;
    void* const arguments[] = {&argument};
    check(memory_.runtime().launch(frame.kernel, size, arguments, stream_.handle()), "start a kernel on the GPU");
}

template <class T>
const T* RayProbe::read_back(const DeviceBuffer<T>& answers, std::size_t count) {
    const std::size_t bytes = count * sizeof(T);
    if (pinned_.bytes() < bytes) {
        pinned_ = {};
        pinned_ = PinnedMemory(memory_.runtime(), bytes);
    }
    check(memory_.runtime().download(pinned_.data(), answers.address(), bytes, stream_.handle()),
          "read the answers of single rays back from the GPU");
    stream_.synchronize("trace single rays on the GPU");
    return reinterpret_cast<const T*>(pinned_.data());
}

std::vector<SurfaceHit> RayProbe::look(std::span<const kernels::Vec2f> film_px, double time) {
    const Frame frame = frame_();
    std::vector<SurfaceHit> found;
    found.reserve(film_px.size());
    while (found.size() < film_px.size()) {
        const auto batch = film_px.subspan(found.size(), std::min(kBatch, film_px.size() - found.size()));
        film_px_.set(memory_, uploads_, batch);
        hits_.reserve(memory_, batch.size(), MemoryUse::tables);
        kernels::ProbeParams params{};
        params.frame = frame.params;
        params.time = static_cast<float>(time);
        params.count = static_cast<unsigned>(batch.size());
        params.film_px = film_px_.data();
        params.hits = static_cast<kernels::ProbeHit*>(hits_.pointer());
        launch(frame, params);
        const kernels::ProbeHit* hits = read_back(hits_, batch.size());
        std::transform(hits, hits + batch.size(), std::back_inserter(found), surface_hit_of<float>);
    }
    return found;
}

std::vector<char> RayProbe::occluded(std::span<const SurfaceRay> rays, double time) {
    const Frame frame = frame_();
    std::vector<char> found;
    found.reserve(rays.size());
    while (found.size() < rays.size()) {
        const auto batch = rays.subspan(found.size(), std::min(kBatch, rays.size() - found.size()));
        std::vector<kernels::ProbeShadow> shadows;
        std::transform(batch.begin(), batch.end(), std::back_inserter(shadows), probe_shadow_of<float>);
        shadows_.set(memory_, uploads_, shadows);
        occluded_.reserve(memory_, batch.size(), MemoryUse::tables);
        kernels::ProbeParams params{};
        params.frame = frame.params;
        params.time = static_cast<float>(time);
        params.count = static_cast<unsigned>(batch.size());
        params.shadows = shadows_.data();
        params.occluded = static_cast<unsigned char*>(occluded_.pointer());
        launch(frame, params);
        const unsigned char* answers = read_back(occluded_, batch.size());
        found.insert(found.end(), answers, answers + batch.size());
    }
    return found;
}

}  // namespace kadr
