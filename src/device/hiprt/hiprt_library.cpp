#include "device/hiprt/hiprt_library.h"

#include <dlfcn.h>

#include <regex>
#include <vector>

#include <fmt/format.h>

#include "base/error.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFileName = "libhiprt0300164.so";
constexpr const char* kFolders[] = {"lib", "lib64", "bin", ""};
constexpr const char* kUsualPlaces[] = {
    "/usr/local/lib", "/usr/lib/x86_64-linux-gnu", "/usr/lib", "/opt/hiprt/lib", "/opt/hiprt/bin", "/opt/rocm/lib"};

std::string version_text(std::uint32_t version) { return fmt::format("{}", version); }

/// The file itself, or the refusal of its version.
Found<fs::path> of_our_version(const fs::path& file) {
    const std::optional<std::uint32_t> version = api_version_of(file);
    if (!version || *version == hiprt::kApiVersion) return file;
    return fmt::format("{} is HIPRT's API {}, but this program works with {} only; install HIPRT 3.1 ({})",
                       file.string(), version_text(*version), hiprt::kApiVersion, kFileName);
}

bool is_hiprt(const fs::path& file) {
    static const std::regex kName("(lib)?hiprt[0-9]*\\.so(\\.[0-9]+)*");
    return std::regex_match(file.filename().string(), kName);
}

/// The library of a folder: ours, else one whose name does not tell, else the refusal of another version.
std::optional<Found<fs::path>> find_in(const HostSystem& machine, const fs::path& folder) {
    std::vector<fs::path> others;
    for (const fs::path& file : machine.files_in(folder)) {
        if (!is_hiprt(file)) continue;
        if (api_version_of(file) == hiprt::kApiVersion) return file;
        others.push_back(file);
    }
    for (const fs::path& file : others)
        if (!api_version_of(file)) return file;
    if (others.empty()) return std::nullopt;
    return of_our_version(others.back());
}

Found<fs::path> find_under(const HostSystem& machine, const fs::path& root) {
    std::optional<Found<fs::path>> refused;
    for (const char* folder : kFolders) {
        const std::optional<Found<fs::path>> found = find_in(machine, root / folder);
        if (found && std::holds_alternative<fs::path>(*found)) return *found;
        if (found && !refused) refused = found;
    }
    if (refused) return *refused;
    return fmt::format(
        "HIPRT_ROOT is {}, but neither its lib nor its bin folder holds {}; set it to the folder that HIPRT 3.1 "
        "was unpacked to",
        root.string(), kFileName);
}

Found<fs::path> find_in_usual_places(const HostSystem& machine) {
    if (machine.can_open(kFileName)) return fs::path(kFileName);
    std::optional<Found<fs::path>> refused;
    for (const char* folder : kUsualPlaces) {
        const std::optional<Found<fs::path>> found = find_in(machine, folder);
        if (found && std::holds_alternative<fs::path>(*found)) return *found;
        if (found && !refused) refused = found;
    }
    if (refused) return *refused;
    return fmt::format(
        "{} is not installed; unpack HIPRT 3.1 and set HIPRT_ROOT to its folder, or KADR_HIPRT_LIBRARY to the file",
        kFileName);
}

template <class F>
void bind(void* library, const fs::path& file, const char* name, F& function) {
    void* symbol = dlsym(library, name);
    if (!symbol)
        throw InputError(fmt::format("{} has no {}", file.string(), name),
                         fmt::format("expected HIPRT's API {}; install HIPRT 3.1 ({})", hiprt::kApiVersion, kFileName));
    function = reinterpret_cast<F>(symbol);
}

}  // namespace

std::optional<std::uint32_t> api_version_of(const fs::path& library) {
    static const std::regex kName("(?:lib)?hiprt([0-9]{5})64\\.so(?:\\.[0-9]+)*");
    const std::string name = library.filename().string();
    std::smatch match;
    if (!std::regex_match(name, match, kName)) return std::nullopt;
    return static_cast<std::uint32_t>(std::stoul(match[1].str()));
}

Found<fs::path> find_hiprt_library(const HostSystem& machine) {
    if (const std::optional<std::string> file = machine.variable("KADR_HIPRT_LIBRARY")) {
        if (machine.is_file(*file)) return of_our_version(*file);
        return fmt::format("KADR_HIPRT_LIBRARY is {}, which is not a file; set it to {}, or leave it unset", *file,
                           kFileName);
    }
    if (const std::optional<std::string> root = machine.variable("HIPRT_ROOT")) return find_under(machine, *root);
    return find_in_usual_places(machine);
}

HiprtLibrary HiprtLibrary::open(const fs::path& file) {
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library)
        throw InputError(fmt::format("{} cannot be opened: {}", file.string(), dlerror()),
                         "expected the library of HIPRT 3.1 with everything that it needs");
    HiprtLibrary opened;
    opened.file_ = file;
    hiprt::Api& api = opened.api_;
    bind(library, file, "hiprtCreateContext", api.create_context);
    bind(library, file, "hiprtDestroyContext", api.destroy_context);
    bind(library, file, "hiprtSetLogLevel", api.set_log_level);
    bind(library, file, "hiprtSetCacheDirPath", api.set_cache_path);
    bind(library, file, "hiprtCreateGeometries", api.create_geometries);
    bind(library, file, "hiprtDestroyGeometry", api.destroy_geometry);
    bind(library, file, "hiprtGetGeometriesBuildTemporaryBufferSize", api.geometries_temporary_size);
    bind(library, file, "hiprtBuildGeometries", api.build_geometries);
    bind(library, file, "hiprtCompactGeometries", api.compact_geometries);
    bind(library, file, "hiprtCreateScene", api.create_scene);
    bind(library, file, "hiprtDestroyScene", api.destroy_scene);
    bind(library, file, "hiprtGetSceneBuildTemporaryBufferSize", api.scene_temporary_size);
    bind(library, file, "hiprtBuildScene", api.build_scene);
    bind(library, file, "hiprtCreateFuncTable", api.create_function_table);
    bind(library, file, "hiprtSetFuncTable", api.set_function_table);
    bind(library, file, "hiprtDestroyFuncTable", api.destroy_function_table);
    bind(library, file, "hiprtBuildTraceKernels", api.build_trace_kernels);
    return opened;
}

}  // namespace kadr
