// What is looked for before a GPU is used: each thing that is missing is one sentence, nothing is opened beyond it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "device/hiprt/gpu_probe.h"
#include "fake_machine.h"

namespace kadr {
namespace {

using test::amd_machine;
using test::FakeMachine;
using test::nvidia_machine;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

std::string missing(const FakeMachine& machine, bool has_runtime = true) {
    const GpuProbe probe = probe_gpu(machine, has_runtime);
    EXPECT_FALSE(probe.complete());
    return probe.missing();
}

TEST(GpuProbe, NvidiaWithEverything) {
    const GpuProbe probe = probe_gpu(nvidia_machine(), true);
    ASSERT_TRUE(probe.complete()) << probe.missing();
    EXPECT_EQ(probe.vendor, GpuVendor::nvidia);
    EXPECT_EQ(probe.hiprt_library, "/opt/hiprt31/lib/libhiprt0300164.so");
    EXPECT_EQ(probe.hiprt_headers, "/opt/hiprt31/include");
    EXPECT_EQ(probe.kernel_folder, "/opt/kadr/share/kadr");
    EXPECT_EQ(probe.needs.size(), 7u);
}

TEST(GpuProbe, AmdWithEverything) {
    const GpuProbe probe = probe_gpu(amd_machine(), true);
    ASSERT_TRUE(probe.complete()) << probe.missing();
    EXPECT_EQ(probe.vendor, GpuVendor::amd);
}

TEST(GpuProbe, WithoutGpuNothingIsOpened) {
    FakeMachine machine = nvidia_machine();
    machine.nodes.clear();
    EXPECT_EQ(
        missing(machine),
        "no GPU: neither /dev/kfd (AMD) nor /dev/nvidiactl (NVIDIA) is there; install the driver of your GPU, or let "
        "this machine or container use it");
    EXPECT_TRUE(machine.opened.empty());
}

TEST(GpuProbe, DriverLibraryMissing) {
    FakeMachine machine = nvidia_machine();
    machine.libraries.erase("libcuda.so.1");
    EXPECT_EQ(missing(machine),
              "the library of the GPU's driver is missing: /dev/nvidiactl is there, but libcuda.so.1 cannot be opened; "
              "install "
              "NVIDIA's driver");
    machine = amd_machine();
    machine.libraries.erase("libamdhip64.so.6");
    EXPECT_EQ(missing(machine),
              "the library of the GPU's driver is missing: /dev/kfd is there, but libamdhip64.so cannot be opened; "
              "install the "
              "HIP runtime (ROCm)");
}

TEST(GpuProbe, CudaRuntimeMissingAndNoVersionedNameWillDo) {
    FakeMachine machine = nvidia_machine();
    machine.libraries.erase("libcudart.so");
    machine.libraries.insert("libcudart.so.12");
    EXPECT_EQ(missing(machine),
              "the CUDA runtime is missing: libcudart.so cannot be opened; install the runtime of CUDA 12, and let "
              "LD_LIBRARY_PATH name the folder that has it under exactly this name");
    // HIPRT crashes without the runtime, so it is not even looked for.
    EXPECT_THAT(machine.opened, Not(Contains(HasSubstr("hiprt0300164"))));
    EXPECT_EQ(machine.opened.back(), "libcudart.so");
}

TEST(GpuProbe, CudaRuntimeOfAnotherVersion) {
    FakeMachine machine = nvidia_machine();
    machine.functions.clear();  // as CUDA 13's
    EXPECT_EQ(
        missing(machine),
        "libcudart.so is not the runtime of CUDA 12 (it has no cudaGetDeviceProperties_v2), which HIPRT 3.1 needs; let "
        "LD_LIBRARY_PATH name the folder of CUDA 12 first");
}

TEST(GpuProbe, CompilerMissing) {
    FakeMachine machine = nvidia_machine();
    machine.libraries.erase("libnvrtc.so");
    EXPECT_THAT(missing(machine),
                HasSubstr("the run-time compiler is missing: libnvrtc.so cannot be opened; install NVRTC"));
    machine.libraries.insert("/usr/local/cuda/lib64/libnvrtc.so");
    EXPECT_TRUE(probe_gpu(machine, true).complete());
    machine = amd_machine();
    machine.libraries.erase("/opt/rocm/lib/libhiprtc.so");
    EXPECT_EQ(missing(machine),
              "the run-time compiler is missing: libhiprtc.so cannot be opened; install the HIP SDK (ROCm)");
}

TEST(GpuProbe, BuiltWithoutOrochi) {
    EXPECT_EQ(missing(nvidia_machine(), false),
              "this program was built without Orochi; build Orochi, and configure with -DOROCHI_ROOT=FOLDER (see the "
              "README)");
}

TEST(GpuProbe, HiprtMissing) {
    FakeMachine machine = nvidia_machine();
    machine.variables.clear();
    EXPECT_EQ(missing(machine),
              "libhiprt0300164.so is not installed; unpack HIPRT 3.1 and set HIPRT_ROOT to its folder, or "
              "KADR_HIPRT_LIBRARY to "
              "the file");
}

TEST(GpuProbe, HeadersMissing) {
    FakeMachine machine = nvidia_machine();
    machine.files.erase("/opt/hiprt31/include/hiprt/impl/hiprt_device_impl.h");
    EXPECT_EQ(missing(machine),
              "HIPRT's headers are missing, from which kernels are compiled; set HIPRT_PATH to the include folder of "
              "HIPRT 3.1");
    machine.variables["HIPRT_PATH"] = "/nowhere";
    EXPECT_EQ(missing(machine),
              "HIPRT_PATH is /nowhere, which does not hold hiprt/impl/hiprt_device_impl.h; set it to the include "
              "folder of HIPRT "
              "3.1");
}

TEST(GpuProbe, HeadersOfAnotherVersion) {
    FakeMachine machine = nvidia_machine();
    machine.files["/opt/hiprt31/include/hiprt/hiprt.h"] = "#define HIPRT_API_VERSION 2005\n";
    EXPECT_EQ(missing(machine),
              "HIPRT's headers in /opt/hiprt31/include are those of its API 2005, but the library's is 3001; set "
              "HIPRT_PATH to "
              "the include folder of HIPRT 3.1");
}

TEST(GpuProbe, KernelsMissing) {
    FakeMachine machine = nvidia_machine();
    machine.files.erase("/opt/kadr/share/kadr/kernels/gpu/launch_params.h");
    EXPECT_THAT(missing(machine), HasSubstr("Kadr's own kernels are missing: neither /opt/kadr/share/kadr nor "));
    machine.variables["KADR_KERNELS"] = "/elsewhere";
    EXPECT_EQ(missing(machine),
              "KADR_KERNELS is /elsewhere, which does not hold kernels/gpu; set it to the folder that holds Kadr's "
              "kernels folder");
    machine.files["/elsewhere/kernels/gpu/launch_params.h"] = "";
    EXPECT_TRUE(probe_gpu(machine, true).complete());
}

TEST(GpuProbe, LookingEndsWithTheFirstThingMissing) {
    FakeMachine machine = nvidia_machine();
    machine.libraries = {"libcuda.so.1"};
    machine.variables.clear();
    const GpuProbe probe = probe_gpu(machine, true);
    ASSERT_EQ(probe.needs.size(), 2u);
    EXPECT_EQ(probe.needs[0].found, "/dev/nvidiactl and libcuda.so.1");
    EXPECT_TRUE(probe.needs[0].missing.empty());
    EXPECT_EQ(probe.needs[1].name, "runtime");
    EXPECT_TRUE(probe.needs[1].found.empty());
}

TEST(GpuProbe, ThisMachineIsLookedAtWithoutCrashing) {
    const GpuProbe probe = probe_gpu(this_machine(), false);
    EXPECT_FALSE(probe.complete());
    EXPECT_FALSE(probe.missing().empty());
}

}  // namespace
}  // namespace kadr
