#include "device/hiprt/trace_kernels.h"

#include <algorithm>

#include <fmt/format.h>

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
    if (context_.runtime().properties().vendor == GpuVendor::amd)
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

hiprt::Function TraceKernels::get(const KernelNeed& need) {
    const auto known = compiled_.find(need);
    if (known != compiled_.end()) return known->second;
    const KernelSource source = source_of(need);
    const char* function_name = source.function.c_str();
    std::vector<const char*> options = pointers_to(source.options);
    hiprt::FunctionNames names[kernels::geometry_type::kCount];
    for (unsigned i = 0; i < kernels::geometry_type::kCount; ++i)
        names[i] = {kernels::kGeometryFunctions[i].intersect, kernels::kGeometryFunctions[i].filter};
    const std::uint32_t geometry_types = need.functions ? kernels::geometry_type::kCount : 0;
    const std::uint32_t ray_types = need.functions ? 1 : 0;
    hiprt::Function function = nullptr;
    check(context_.api().build_trace_kernels(context_.handle(), 1, &function_name, source.text.c_str(),
                                             source.module.c_str(), 0, nullptr, nullptr,
                                             static_cast<std::uint32_t>(options.size()), options.data(), geometry_types,
                                             ray_types, need.functions ? names : nullptr, &function, nullptr, true),
          fmt::format("compile the kernel {} for {} (what HIPRT printed above says why)",
                      source.function, names_of_requirements(need.requirements)));
    compiled_[need] = function;
    return function;
}

}  // namespace kadr
