#include "device/hiprt/trace_kernels.h"

#include <algorithm>
#include <chrono>
#include <future>
#include <thread>

#include <fmt/format.h>

#include "base/detached_work.h"
#include "base/error.h"
#include "base/hash.h"
#include "device/hiprt/hiprt_error.h"
#include "device/requirement_names.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

/// Of all files under a folder: their paths from there and what they hold.
std::string hash_folder(const fs::path& folder) {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    Hasher hasher;
    for (const fs::path& file : files) {
        hasher.add(file.lexically_relative(folder).generic_string());
        hasher.add(hash_file(file).hex());
    }
    return hasher.finish().hex();
}

std::vector<const char*> pointers_to(const std::vector<std::string>& texts) {
    std::vector<const char*> pointers;
    for (const std::string& text : texts) pointers.push_back(text.c_str());
    return pointers;
}

}  // namespace

std::string hash_of_kernels(const std::filesystem::path& folder) { return hash_folder(folder / "kernels"); }

KernelSource TraceKernels::source_of(const KernelNeed& need) {
    if (hash_.empty()) hash_ = hash_of_kernels(folder_);
    const kernels::EntryPoint& entry = kernels::entry_point(need.kernel);
    KernelSource source;
    source.function = entry.name;
    source.text = fmt::format("#define KADR_REQUIREMENTS {}u\n#include \"{}\"\n",
                              kernels::kernel_requirements(need.kernel, need.requirements), entry.header);
    source.options = {"-I" + folder_.string()};  // HIPRT itself asks for C++17
    if (context_->runtime().properties().vendor == GpuVendor::amd)
        source.options.insert(source.options.end(), std::begin(kernels::kHipOptions), std::end(kernels::kHipOptions));
    else
        source.options.insert(source.options.end(), std::begin(kernels::kCudaOptions), std::end(kernels::kCudaOptions));
    Hasher hasher;
    hasher.add(hash_);
    hasher.add(source.text);
    for (const std::string& option : source.options) hasher.add(option);
    hasher.add(static_cast<std::int64_t>(hiprt::kApiVersion));
    source.module =
        fmt::format("{}_{}{}_{}", entry.name, need.requirements, need.functions ? "f" : "", hasher.finish().hex());
    return source;
}

/// A kernel on its way: written by its thread until `done`, read by others after that.
struct TraceKernels::Compilation {
    KernelNeed need;
    KernelSource source;
    std::chrono::steady_clock::time_point begin = std::chrono::steady_clock::now();
    hiprt::Error result = hiprt::Error::internal;
    GpuResult context_result;
    hiprt::Function function = nullptr;
    std::promise<void> promise;
    std::shared_future<void> done = promise.get_future().share();

    bool succeeded() const { return context_result.kind == GpuResult::Kind::success && result == hiprt::Error::success; }
    bool is_done() const { return done.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }
};

void TraceKernels::begin(const KernelNeed& need) {
    if (find(need)) return;
    auto compilation = std::make_shared<Compilation>();
    compilation->need = need;
    compilation->source = source_of(need);
    std::thread([context = context_, compilation]() mutable {
        const DetachedWork counts;
        compile(*context, *compilation);
        context.reset();  // where the device is gone, this ends HIPRT, in a thread that may
        compilation->promise.set_value();
    }).detach();
    compilations_.push_back(std::move(compilation));
}

void TraceKernels::compile(HiprtContext& context, Compilation& compilation) {
    compilation.context_result = context.runtime().make_current();
    if (compilation.context_result.kind != GpuResult::Kind::success) return;
    const KernelSource& source = compilation.source;
    const char* function_name = source.function.c_str();
    std::vector<const char*> options = pointers_to(source.options);
    hiprt::FunctionNames names[kernels::geometry_type::kCount];
    for (unsigned i = 0; i < kernels::geometry_type::kCount; ++i)
        names[i] = {kernels::kGeometryFunctions[i].intersect, kernels::kGeometryFunctions[i].filter};
    const bool functions = compilation.need.functions;
    const std::uint32_t geometry_types = functions ? kernels::geometry_type::kCount : 0, ray_types = functions ? 1 : 0;
    compilation.result = context.api().build_trace_kernels(
        context.handle(), 1, &function_name, source.text.c_str(), source.module.c_str(), 0, nullptr, nullptr,
        static_cast<std::uint32_t>(options.size()), options.data(), geometry_types, ray_types,
        functions ? names : nullptr, &compilation.function, nullptr, true);
}

/// The one for exactly this, or one that covers it.
std::shared_ptr<TraceKernels::Compilation> TraceKernels::find(const KernelNeed& need) const {
    for (const auto& compilation : compilations_)
        if (compilation->need == need) return compilation;
    for (const auto& compilation : compilations_)
        if (compilation->need.covers(need)) return compilation;
    return nullptr;
}

void TraceKernels::wait_for(const Compilation& compilation, const Waiting& waiting) {
    // Often enough for who cancels, and for a clock that shows tenths.
    constexpr std::chrono::milliseconds kTick{100};
    while (compilation.done.wait_for(kTick) != std::future_status::ready)
        if (waiting) waiting(std::chrono::duration<double>(std::chrono::steady_clock::now() - compilation.begin).count());
}

void TraceKernels::wait(const Waiting& waiting) const {
    for (const auto& compilation : compilations_) wait_for(*compilation, waiting);
}

bool TraceKernels::is_compiling() const {
    return std::any_of(compilations_.begin(), compilations_.end(), [](const auto& compilation) { return !compilation->is_done(); });
}

TraceKernel TraceKernels::get(const KernelNeed& need, const Waiting& waiting) {
    begin(need);
    const std::shared_ptr<Compilation> compilation = find(need);
    wait_for(*compilation, waiting);
    if (!compilation->succeeded()) std::erase(compilations_, compilation);  // who asks next tries anew
    check(compilation->context_result, "use the GPU");
    check(compilation->result, fmt::format("compile the kernel {} for {} (what HIPRT printed above says why)",
                                           compilation->source.function, names_of_requirements(compilation->need.requirements)));
    return {compilation->function, compilation->need};
}

}  // namespace kadr
