#pragma once

#include <memory>
#include <string>

#include "device/hiprt/hiprt_device.h"
#include "fake_hiprt.h"
#include "kernels/gpu/launch_params.h"
#include "recording_runtime.h"

namespace kadr::test {

/// A GPU device over the fakes. Its kernel does not trace: it checks that every address that it is given is memory of
/// the GPU, and adds known numbers to the film: a sample of pixel (x, y) is worth (x, y, sample), its alpha is 1.
struct FakeGpu {
    std::shared_ptr<RecordingRuntime> runtime = std::make_shared<RecordingRuntime>();
    FakeHiprt hiprt{*runtime};
    double seconds_a_sample = 1e-9;  ///< of a pixel
    std::vector<kernels::LaunchParams> launches;

    FakeGpu();
    /// The device; a call of it may be set to fail first.
    std::unique_ptr<Device> make();
    /// Faults and leaks, one a line; empty when all is well. @pre the device is gone
    std::string complaints() const;

private:
    double run(const std::string& function, const kernels::LaunchParams& params);
    void check_addresses(const kernels::LaunchParams& params);
    void check_scene(const kernels::SceneView& scene, std::size_t instance_count);
    void check_geometry(const kernels::Geometry& geometry);
    template <class T>
    void expect(const T* address, std::size_t count, const char* what) {
        if (count > 0) runtime->expect_device({reinterpret_cast<std::uintptr_t>(address), count * sizeof(T)}, what);
    }
};

}  // namespace kadr::test
