#pragma once

#include <cstring>
#include <memory>
#include <optional>
#include <string>

#include "device/hiprt/hiprt_device.h"
#include "fake_hiprt.h"
#include "kernels/gpu/entry_points.h"
#include "recording_runtime.h"

namespace kadr::test {

/// The argument of a launch.
template <class T>
T argument_of(const std::byte* bytes) {
    T argument;
    std::memcpy(static_cast<void*>(&argument), bytes, sizeof argument);
    return argument;
}

/// A GPU device over the fakes. Its kernel does not trace: it checks that every address that it is given is memory of
/// the GPU, and adds known numbers to the film: a sample of pixel (x, y) is worth (x, y, sample), its alpha is 1. Single
/// rays meet nothing.
struct FakeGpu {
    std::shared_ptr<RecordingRuntime> runtime = std::make_shared<RecordingRuntime>();
    FakeHiprt hiprt{*runtime};
    double seconds_a_sample = 1e-9;  ///< of a pixel
    std::vector<kernels::LaunchParams> launches;
    std::vector<kernels::ProbeParams> probes;

    FakeGpu();
    /// The device; a call of it may be set to fail first.
    std::unique_ptr<Device> make();
    /// Faults and leaks, one a line; empty when all is well. @pre the device is gone
    std::string complaints() const;
    /// Checks a launch of single rays. Nothing is met, everything is in shadow.
    double run_probe(const kernels::ProbeParams& params);
    /// Checks a launch of a kernel that makes vertices or boxes, and runs it.
    double run_bend(const kernels::BendParams& params);
    double run_boxes(const kernels::BoxParams& params);
    /// Runs a launch that traces no rays of a pixel. @return nothing where it does
    std::optional<double> run_other(const std::string& function, const std::byte* argument);

private:
    double run(const std::string& function, const kernels::LaunchParams& params);
    void check_film(const kernels::LaunchParams& params);
    void check_frame(const kernels::LaunchParams& params);
    void check_scene(const kernels::SceneView& scene, std::size_t instance_count);
    void check_geometry(const kernels::Geometry& geometry);
    template <class T>
    void expect(const T* address, std::size_t count, const char* what) {
        if (count > 0) runtime->expect_device({reinterpret_cast<std::uintptr_t>(address), count * sizeof(T)}, what);
    }
};

}  // namespace kadr::test
