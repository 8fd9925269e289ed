#include "device/hiprt/hiprt_handles.h"

#include <cstdio>

#include <fmt/format.h>

#include "device/hiprt/hiprt_error.h"
#include "kernels/gpu/launch_params.h"

namespace kadr {
namespace {

void report_error(hiprt::Error error, const char* action) {
    if (error != hiprt::Error::success)
        fmt::print(stderr, "kadr: cannot {}: HIPRT reports {}\n", action, text_of(error));
}

}  // namespace

void check_created(hiprt::Error result, const char* what, GpuMemory& memory) {
    if (result == hiprt::Error::internal || result == hiprt::Error::out_of_device_memory)
        throw GpuOutOfMemory(fmt::format("cannot make room for {}: HIPRT reports {}, most often a full memory ({})",
                                         what, text_of(result), memory.summary()));
    check(result, fmt::format("make room for {}", what));
}

HiprtContext::HiprtContext(const hiprt::Api& api, GpuRuntime& runtime, const std::filesystem::path& cache)
    : api_(api), runtime_(runtime) {
    const hiprt::ContextCreationInput input{
        runtime.native_context(), runtime.native_device(),
        runtime.properties().vendor == GpuVendor::amd ? hiprt::DeviceType::amd : hiprt::DeviceType::nvidia};
    const hiprt::Error created = api.create_context(hiprt::kApiVersion, input, handle_);
    if (created == hiprt::Error::invalid_api_version)
        throw RenderError(
            fmt::format("cannot use this libhiprt: it is not of API {}; install HIPRT 3.1", hiprt::kApiVersion));
    check(created, "start HIPRT on the GPU");
    // From here on the destructor does not run yet: what fails has to be undone by hand.
    hiprt::Error result = api.set_log_level(handle_, hiprt::log_level::kErrors | hiprt::log_level::kWarnings);
    if (result == hiprt::Error::success && !cache.empty()) result = api.set_cache_path(handle_, cache.c_str());
    if (result == hiprt::Error::success) return;
    report_error(api.destroy_context(handle_), "stop HIPRT");
    check(result, "set HIPRT up");
}

HiprtContext::~HiprtContext() {
    report(runtime_.synchronize_all(), "wait for the GPU");
    report_error(api_.destroy_context(handle_), "stop HIPRT");
}

HiprtGeometry& HiprtGeometry::operator=(HiprtGeometry&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(memory_, other.memory_);
    std::swap(handle_, other.handle_);
    std::swap(bytes_, other.bytes_);
    return *this;
}

HiprtGeometry::~HiprtGeometry() {
    if (!memory_) return;
    memory_->note_given_back(bytes_, MemoryUse::structures);
    if (!handle_) return;
    report(context_->runtime().synchronize_all(), "wait for the GPU");
    report_error(context_->api().destroy_geometry(context_->handle(), handle_), "free the structure of a mesh");
}

void HiprtGeometry::note_bytes(std::size_t bytes) {
    memory_->note_given_back(bytes_, MemoryUse::structures);
    memory_->note_taken(bytes, MemoryUse::structures);
    bytes_ = bytes;
}

HiprtTopLevel::HiprtTopLevel(HiprtContext& context, GpuMemory& memory, const hiprt::SceneBuildInput& input,
                             const hiprt::BuildOptions& options) {
    const std::size_t before = memory.free_bytes();
    HiprtTopLevel made;  // whose destructor frees it if asking for the memory fails
    check_created(context.api().create_scene(context.handle(), input, options, made.handle_),
                  "the structure of all instances", memory);
    made.context_ = &context;
    made.memory_ = &memory;
    const std::size_t after = memory.free_bytes();
    made.bytes_ = before > after ? before - after : 0;
    memory.note_taken(made.bytes_, MemoryUse::structures);
    made.made_for_ = input;
    made.options_ = options;
    *this = std::move(made);
}

bool HiprtTopLevel::fits(const hiprt::SceneBuildInput& input, const hiprt::BuildOptions& options) const {
    return handle_ && options_ == options && made_for_.instance_count == input.instance_count &&
           made_for_.frame_count == input.frame_count && made_for_.frame_type == input.frame_type;
}

HiprtTopLevel& HiprtTopLevel::operator=(HiprtTopLevel&& other) noexcept {
    std::swap(context_, other.context_);
    std::swap(memory_, other.memory_);
    std::swap(handle_, other.handle_);
    std::swap(bytes_, other.bytes_);
    std::swap(made_for_, other.made_for_);
    std::swap(options_, other.options_);
    return *this;
}

HiprtTopLevel::~HiprtTopLevel() {
    if (!handle_) return;
    memory_->note_given_back(bytes_, MemoryUse::structures);
    report(context_->runtime().synchronize_all(), "wait for the GPU");
    report_error(context_->api().destroy_scene(context_->handle(), handle_), "free the structure of all instances");
}

HiprtFunctionTable::HiprtFunctionTable(HiprtContext& context) : context_(context) {
    const hiprt::Api& api = context.api();
    constexpr unsigned kTypes = kernels::geometry_type::kCount;
    check(api.create_function_table(context.handle(), kTypes, 1, handle_), "make HIPRT's function table");
    hiprt::Error set = hiprt::Error::success;
    for (unsigned type = 0; type < kTypes && set == hiprt::Error::success; ++type)
        set = api.set_function_table(context.handle(), handle_, type, 0, {});
    if (set == hiprt::Error::success) return;
    report_error(api.destroy_function_table(context.handle(), handle_), "free HIPRT's function table");
    check(set, "fill HIPRT's function table");
}

HiprtFunctionTable::~HiprtFunctionTable() {
    report(context_.runtime().synchronize_all(), "wait for the GPU");
    report_error(context_.api().destroy_function_table(context_.handle(), handle_), "free HIPRT's function table");
}

}  // namespace kadr
