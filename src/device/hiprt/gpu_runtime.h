#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <source_location>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace kadr {

/// Where something lies in the memory of a GPU; 0: nowhere.
using DeviceAddress = std::uintptr_t;

enum class GpuVendor { amd, nvidia };

struct GpuProperties {
    std::string name;          ///< "NVIDIA H200"
    std::string architecture;  ///< "sm_90", "gfx1100"
    GpuVendor vendor = GpuVendor::amd;
    std::size_t total_bytes = 0;
    int compute = 0;  ///< NVIDIA: compute capability, 75 is 7.5
};

/// What a call to the GPU came to.
struct GpuResult {
    enum class Kind { success, out_of_memory, not_ready, failure };
    Kind kind = Kind::success;
    std::string text;  ///< what the runtime reports; empty on success
    bool operator==(const GpuResult&) const = default;
};

/// The memory of the GPU does not hold what was asked for.
class GpuOutOfMemory : public RenderError {
public:
    using RenderError::RenderError;
};

/// "hiprt_scene.cpp:120"
std::string place_of(const std::source_location& where);

/// @param action  reads as the end of "cannot ..."
/// @throws GpuOutOfMemory, RenderError  with the action and what the runtime reports, unless it is a success
void check(const GpuResult& result, std::string_view action,
           std::source_location where = std::source_location::current());

// Handles of the runtime, owned by the classes of gpu_resources.h.
using GpuStreamHandle = void*;
using GpuEventHandle = void*;
using GpuFunctionHandle = void*;

struct LaunchSize {
    unsigned grid_x = 1, grid_y = 1;    ///< blocks
    unsigned block_x = 1, block_y = 1;  ///< threads a block
};

/// One GPU: memory, streams, events and launches (HIPRT compiles and loads the modules); what is under HIPRT. The one
/// that renders is Orochi's (orochi_runtime.cpp); tests have one that records and checks.
///
/// Calls return what they came to and never throw. make_current() comes first in every thread. Work on a stream runs in
/// order and after the call has returned; host memory that it reads or writes has to be pinned and stay until then.
class GpuRuntime {
public:
    virtual ~GpuRuntime() = default;

    virtual GpuProperties properties() const = 0;
    virtual GpuResult make_current() = 0;
    virtual GpuResult memory(std::size_t& free_bytes, std::size_t& total_bytes) = 0;
    /// What HIPRT is given: hipCtx_t or CUcontext, and the device's number.
    virtual void* native_context() const = 0;
    virtual int native_device() const = 0;

    virtual GpuResult allocate(std::size_t bytes, DeviceAddress& address) = 0;
    virtual GpuResult release(DeviceAddress address) = 0;  ///< @pre no pending work uses it
    virtual GpuResult allocate_pinned(std::size_t bytes, void*& memory) = 0;
    virtual GpuResult release_pinned(void* memory) = 0;  ///< @pre no pending work uses it

    virtual GpuResult create_stream(GpuStreamHandle& stream) = 0;
    virtual GpuResult destroy_stream(GpuStreamHandle stream) = 0;
    virtual GpuResult synchronize(GpuStreamHandle stream) = 0;  ///< waits for what is on the stream
    virtual GpuResult synchronize_all() = 0;                    ///< waits for all streams

    /// @param from  pinned
    virtual GpuResult upload(DeviceAddress to, const void* from, std::size_t bytes, GpuStreamHandle stream) = 0;
    /// @param to  pinned
    virtual GpuResult download(void* to, DeviceAddress from, std::size_t bytes, GpuStreamHandle stream) = 0;
    virtual GpuResult fill(DeviceAddress to, std::uint8_t value, std::size_t bytes, GpuStreamHandle stream) = 0;

    virtual GpuResult create_event(GpuEventHandle& event) = 0;
    virtual GpuResult destroy_event(GpuEventHandle event) = 0;
    virtual GpuResult record(GpuEventHandle event, GpuStreamHandle stream) = 0;
    virtual GpuResult wait_for(GpuEventHandle event) = 0;  ///< until the work before it is done
    /// What comes on the stream from now on begins when the event, as it was recorded last, is past; nobody waits here.
    virtual GpuResult make_wait(GpuStreamHandle stream, GpuEventHandle event) = 0;
    virtual GpuResult query(GpuEventHandle event) = 0;     ///< success, or not_ready
    virtual GpuResult elapsed(GpuEventHandle begin, GpuEventHandle end, double& seconds) = 0;

    /// @param arguments  addresses of the arguments, which are copied before the call returns
    virtual GpuResult launch(GpuFunctionHandle function, const LaunchSize& size, std::span<void* const> arguments,
                             GpuStreamHandle stream) = 0;
};

}  // namespace kadr
