#include "output/image_module.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <cstdlib>
#include <future>
#include <mutex>

#include "base/error.h"
#include "base/version.h"
#include "output/atomic_file.h"

namespace kadr {
namespace {

namespace fs = std::filesystem;

// <prefix>/bin/kadr is one folder below <prefix>; the programs of a build folder (src/cli, tests/output) are two.
constexpr int kFoldersAboveExecutable = 3;

std::vector<fs::path> module_candidates() {
    if (const char* given = std::getenv("KADR_IMAGE_MODULE"); given && *given) return {given};
    std::vector<fs::path> candidates;
    std::error_code failed;
    fs::path folder = fs::read_symlink("/proc/self/exe", failed).parent_path();
    for (int i = 0; i <= kFoldersAboveExecutable && !failed; ++i, folder = folder.parent_path())
        candidates.push_back(folder / "lib" / "kadr" / kImageModuleFile);
    return candidates;
}

fs::path find_module() {
    const std::vector<fs::path> candidates = module_candidates();
    std::error_code ignored;
    for (const fs::path& candidate : candidates)
        if (fs::is_regular_file(candidate, ignored)) return candidate;
    std::string tried;
    for (const fs::path& candidate : candidates) tried += "\n  looked for " + candidate.string();
    throw RenderError("cannot find Kadr's image module " + std::string(kImageModuleFile) +
                      "; install Kadr again, or set KADR_IMAGE_MODULE to the file" + tried);
}

template <class Function>
Function* find_function(void* module, const char* name, const fs::path& path) {
    if (void* address = dlsym(module, name)) return reinterpret_cast<Function*>(address);
    throw RenderError(fmt::format("{} is not an image module of Kadr (it has no {})", path.string(), name));
}

/// Stays open until the process ends: OpenImageIO's own threads and static objects do not survive being unloaded.
std::shared_ptr<const ImageIo> load_module() {
    const fs::path path = find_module();
    void* module = dlopen(path.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (!module) throw RenderError(fmt::format("cannot open the image module: {}", dlerror()));
    const std::string version = find_function<ImageModuleVersion>(module, kImageModuleVersion, path)();
    if (version != kVersion)
        throw RenderError(fmt::format("the image module {} is of Kadr {}, this program of Kadr {}; install Kadr again",
                                      path.string(), version, kVersion));
    return std::shared_ptr<const ImageIo>(find_function<ImageModuleFactory>(module, kImageModuleFactory, path)());
}

using FutureImageIo = std::shared_future<std::shared_ptr<const ImageIo>>;

const FutureImageIo& opened_module() {
    static const FutureImageIo future = std::async(std::launch::async, load_module).share();
    return future;
}

}  // namespace

void ImageIo::write(const fs::path& path, const std::string& format, const Image& image, int bits,
                    const Metadata& metadata) const {
    write_synced(path, encode(format, image, bits, metadata));
}

void open_image_io_in_background() { opened_module(); }

const ImageIo& image_io() { return *opened_module().get(); }

}  // namespace kadr
