// The GPU runtime through Orochi, which opens HIP or CUDA when the program runs. Compiled where CMake found Orochi.
// Source of its rules: Orochi.h and Orochi.cpp of 2025.

#include "device/hiprt/orochi_runtime.h"

#include <Orochi/Orochi.h>

#include <optional>

#include <fmt/format.h>

namespace kadr {
namespace {

oroApi api_of(GpuVendor vendor) { return vendor == GpuVendor::amd ? ORO_API_HIP : ORO_API_CUDA; }

/// Orochi translates CUDA's errors to HIP's numbers, but not their texts; the name is right for both.
std::string text_of(oroError error) {
    const char* name = oroGetErrorName(error);
    return name ? fmt::format("{} ({})", name, static_cast<int>(error))
                : fmt::format("error {}", static_cast<int>(error));
}

GpuResult result_of(oroError error) {
    using Kind = GpuResult::Kind;
    if (error == oroSuccess) return {};
    if (error == oroErrorOutOfMemory) return {Kind::out_of_memory, text_of(error)};
    if (error == oroErrorNotReady) return {Kind::not_ready, text_of(error)};
    return {Kind::failure, text_of(error)};
}

/// oroInit reports success even when nothing was loaded; oroInitialize tells, but only when it is called first: after a
/// failure its second call reports success with no function in place.
void start_driver_once(GpuVendor vendor) {
    if (oroInitialize(api_of(vendor), 0) != ORO_SUCCESS)
        throw RenderError("cannot start the GPU's driver: Orochi loaded none of its libraries");
    const oroApi driver = vendor == GpuVendor::amd ? ORO_API_HIPDRIVER : ORO_API_CUDADRIVER;
    if ((oroLoadedAPI() & driver) == 0)
        throw RenderError(fmt::format("cannot start the GPU's driver: this Orochi was built without {}",
                                      vendor == GpuVendor::amd ? "HIP" : "CUDA (OROCHI_ENABLE_CUEW)"));
    check(result_of(oroInit(0)), "start the GPU's driver");
}

/// @throws RenderError  the same one every time
void start_driver(GpuVendor vendor) {
    static std::optional<std::string> failures[2];  ///< by vendor; empty text: it works
    std::optional<std::string>& failure = failures[static_cast<int>(vendor)];
    if (!failure) try {
            start_driver_once(vendor);
            failure = "";
        } catch (const RenderError& error) {
            failure = error.what();
        }
    if (!failure->empty()) throw RenderError(*failure);
}

oroStream stream_of(GpuStreamHandle stream) { return static_cast<oroStream>(stream); }
oroEvent event_of(GpuEventHandle event) { return static_cast<oroEvent>(event); }
oroDeviceptr pointer_of(DeviceAddress address) { return reinterpret_cast<oroDeviceptr>(address); }

class OrochiRuntime final : public GpuRuntime {
public:
    OrochiRuntime(GpuVendor vendor, int ordinal) {
        start_driver(vendor);
        check(result_of(oroDeviceGet(&device_, ordinal)), fmt::format("take GPU {}", ordinal));
        oroDeviceProp properties{};
        // Not oroDeviceGetAttribute, which passes HIP's numbers of attributes on to CUDA.
        check(result_of(oroGetDeviceProperties(&properties, device_)), fmt::format("ask what GPU {} is", ordinal));
        properties_.vendor = vendor;
        properties_.name = properties.name;
        properties_.total_bytes = properties.totalGlobalMem;
        if (vendor == GpuVendor::nvidia) properties_.compute = 10 * properties.major + properties.minor;
        properties_.architecture = vendor == GpuVendor::amd
                                       ? std::string(properties.gcnArchName)
                                       : fmt::format("sm_{}{}", properties.major, properties.minor);
        check(result_of(oroCtxCreate(&context_, 0, device_)), fmt::format("use GPU {}", ordinal));
    }
    ~OrochiRuntime() override {
        if (context_) oroCtxDestroy(context_);
    }
    OrochiRuntime(const OrochiRuntime&) = delete;
    OrochiRuntime& operator=(const OrochiRuntime&) = delete;

    GpuProperties properties() const override { return properties_; }
    GpuResult make_current() override { return result_of(oroCtxSetCurrent(context_)); }
    GpuResult memory(std::size_t& free_bytes, std::size_t& total_bytes) override {
        return result_of(oroMemGetInfo(&free_bytes, &total_bytes));
    }
    void* native_context() const override { return oroGetRawCtx(context_); }
    int native_device() const override { return oroGetRawDevice(device_); }

    GpuResult allocate(std::size_t bytes, DeviceAddress& address) override {
        void* memory = nullptr;
        const oroError error = oroMalloc(&memory, bytes);
        address = reinterpret_cast<DeviceAddress>(memory);
        return result_of(error);
    }
    GpuResult release(DeviceAddress address) override { return result_of(oroFree(reinterpret_cast<void*>(address))); }
    GpuResult allocate_pinned(std::size_t bytes, void*& memory) override {
        return result_of(oroHostMalloc(&memory, bytes, 0));
    }
    GpuResult release_pinned(void* memory) override { return result_of(oroHostFree(memory)); }

    GpuResult create_stream(GpuStreamHandle& stream) override {
        oroStream created = nullptr;
        const oroError error = oroStreamCreate(&created);
        stream = created;
        return result_of(error);
    }
    GpuResult destroy_stream(GpuStreamHandle stream) override { return result_of(oroStreamDestroy(stream_of(stream))); }
    GpuResult synchronize(GpuStreamHandle stream) override {
        return result_of(oroStreamSynchronize(stream_of(stream)));
    }
    GpuResult synchronize_all() override { return result_of(oroCtxSynchronize()); }

    GpuResult upload(DeviceAddress to, const void* from, std::size_t bytes, GpuStreamHandle stream) override {
        return result_of(oroMemcpyHtoDAsync(pointer_of(to), const_cast<void*>(from), bytes, stream_of(stream)));
    }
    GpuResult download(void* to, DeviceAddress from, std::size_t bytes, GpuStreamHandle stream) override {
        return result_of(oroMemcpyDtoHAsync(to, pointer_of(from), bytes, stream_of(stream)));
    }
    GpuResult fill(DeviceAddress to, std::uint8_t value, std::size_t bytes, GpuStreamHandle stream) override {
        return result_of(oroMemsetD8Async(pointer_of(to), value, bytes, stream_of(stream)));
    }

    GpuResult create_event(GpuEventHandle& event) override {
        oroEvent created = nullptr;
        const oroError error = oroEventCreate(&created);
        event = created;
        return result_of(error);
    }
    GpuResult destroy_event(GpuEventHandle event) override { return result_of(oroEventDestroy(event_of(event))); }
    GpuResult record(GpuEventHandle event, GpuStreamHandle stream) override {
        return result_of(oroEventRecord(event_of(event), stream_of(stream)));
    }
    GpuResult wait_for(GpuEventHandle event) override { return result_of(oroEventSynchronize(event_of(event))); }
    GpuResult make_wait(GpuStreamHandle stream, GpuEventHandle event) override {
        return result_of(oroStreamWaitEvent(stream_of(stream), event_of(event), 0));
    }
    GpuResult query(GpuEventHandle event) override { return result_of(oroEventQuery(event_of(event))); }
    GpuResult elapsed(GpuEventHandle begin, GpuEventHandle end, double& seconds) override {
        float milliseconds = 0;
        const oroError error = oroEventElapsedTime(&milliseconds, event_of(begin), event_of(end));
        seconds = 1e-3 * milliseconds;
        return result_of(error);
    }

    GpuResult launch(GpuFunctionHandle function, const LaunchSize& size, std::span<void* const> arguments,
                     GpuStreamHandle stream) override {
        return result_of(oroModuleLaunchKernel(static_cast<oroFunction>(function), size.grid_x, size.grid_y, 1,
                                               size.block_x, size.block_y, 1, 0, stream_of(stream), arguments.data(),
                                               nullptr));
    }

private:
    oroDevice device_ = 0;
    oroCtx context_ = nullptr;
    GpuProperties properties_;
};

}  // namespace

bool built_with_orochi() { return true; }

int count_gpus(GpuVendor vendor) {
    start_driver(vendor);
    int count = 0;
    check(result_of(oroGetDeviceCount(&count, api_of(vendor))), "count the GPUs");
    return count;
}

std::unique_ptr<GpuRuntime> make_orochi_runtime(GpuVendor vendor, int ordinal) {
    return std::make_unique<OrochiRuntime>(vendor, ordinal);
}

}  // namespace kadr
