#include "denoise/denoiser.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/cache_folder.h"
#include "base/error.h"
#include "denoise/oidn_api.h"

namespace kadr {

namespace {

namespace fs = std::filesystem;

constexpr const char* kLibraryFile = "libOpenImageDenoise.so.2";
constexpr int kMajorVersion = 2;
constexpr const char* kAdvice =
    "install Open Image Denoise 2 (pip install pyoidn brings it), or set KADR_OIDN_LIBRARY to its libOpenImageDenoise.so.2; or use render.denoise: none";

// --- The library -----------------------------------------------------------------------------------------------------

template <class Function>
bool find(void* library, const char* name, Function*& function) {
    function = reinterpret_cast<Function*>(dlsym(library, (std::string("oidn") + name).c_str()));
    return function != nullptr;
}

bool find_all(void* library, oidn::Api& api) {
    return find(library, "NewDevice", api.NewDevice) && find(library, "ReleaseDevice", api.ReleaseDevice) &&
           find(library, "CommitDevice", api.CommitDevice) && find(library, "SetDeviceBool", api.SetDeviceBool) &&
           find(library, "GetDeviceInt", api.GetDeviceInt) && find(library, "GetDeviceError", api.GetDeviceError) &&
           find(library, "NewFilter", api.NewFilter) && find(library, "ReleaseFilter", api.ReleaseFilter) &&
           find(library, "SetSharedFilterImage", api.SetSharedFilterImage) && find(library, "SetFilterBool", api.SetFilterBool) &&
           find(library, "CommitFilter", api.CommitFilter) && find(library, "ExecuteFilter", api.ExecuteFilter);
}

/// Folders of the Python packages under a prefix, and of what Kadr keeps in its cache, that hold the library.
std::vector<fs::path> packages_under(const fs::path& prefix) {
    std::vector<fs::path> found;
    std::error_code ignored;
    for (const fs::directory_entry& python : fs::directory_iterator(prefix, ignored))
        for (const char* packages : {"site-packages", "dist-packages"})
            if (python.path().filename().string().starts_with("python3"))
                found.push_back(python.path() / packages / "pyoidn" / "oidn" / "lib" / kLibraryFile);
    std::sort(found.begin(), found.end());
    return found;
}

std::vector<std::string> candidates() {
    if (const char* given = std::getenv("KADR_OIDN_LIBRARY"); given && *given) return {given};
    std::vector<fs::path> places;
    if (const auto cache = cache_folder()) places.push_back(*cache / "oidn" / "pyoidn" / "oidn" / "lib" / kLibraryFile);
    const auto add = [&](const fs::path& prefix) {
        const std::vector<fs::path> more = packages_under(prefix);
        places.insert(places.end(), more.begin(), more.end());
    };
    if (const char* environment = std::getenv("VIRTUAL_ENV"); environment && *environment) add(fs::path(environment) / "lib");
    if (const char* home = std::getenv("HOME"); home && *home) add(fs::path(home) / ".local" / "lib");
    add("/usr/local/lib"), add("/usr/lib");
    std::vector<std::string> files{kLibraryFile};  // where the system's loader looks
    std::error_code ignored;
    for (const fs::path& place : places)
        if (fs::exists(place, ignored)) files.push_back(place.string());
    return files;
}

// --- One image -------------------------------------------------------------------------------------------------------

struct ReleaseFilter {
    const oidn::Api* api;
    void operator()(oidn::Filter filter) const { api->ReleaseFilter(filter); }
};

std::optional<std::size_t> channel(const Image& image, const std::string& name) {
    const auto found = std::find(image.channels.begin(), image.channels.end(), name);
    if (found == image.channels.end()) return std::nullopt;
    return static_cast<std::size_t>(found - image.channels.begin());
}

/// First of three channels that lie side by side.
std::optional<std::size_t> triple(const Image& image, const std::array<const char*, 3>& names) {
    const std::optional<std::size_t> first = channel(image, names[0]);
    for (std::size_t i = 1; first && i < names.size(); ++i)
        if (channel(image, names[i]) != *first + i) return std::nullopt;
    return first;
}

class OidnDenoiser final : public Denoiser {
public:
    OidnDenoiser(const oidn::Api& api, const std::string& file) : api_(api), device_(api_.NewDevice(oidn::kCpuDevice)) {
        if (!device_) throw InputError(fmt::format("{} starts no CPU device{}", file, reason(nullptr)), kAdvice);
        // Threads bound to cores would stay bound when they trace the next frame.
        api_.SetDeviceBool(device_, "setAffinity", false);
        api_.CommitDevice(device_);
        if (const std::string why = reason(device_); !why.empty()) throw InputError(fmt::format("{} starts no CPU device{}", file, why), kAdvice);
        const int number = api_.GetDeviceInt(device_, "version");
        version_ = fmt::format("{}.{}.{}", number / 10000, number / 100 % 100, number % 100);
        if (number / 10000 != kMajorVersion) throw InputError(fmt::format("{} is Open Image Denoise {}", file, version_), fmt::format("expected version {}; {}", kMajorVersion, kAdvice));
    }
    // The device lives as long as the program: threads of the library may outlast static objects.

    std::string version() const override { return version_; }

    void apply(Image& image) const override {
        const std::unique_ptr<oidn::FilterHandle, ReleaseFilter> filter(api_.NewFilter(device_, "RT"), {&api_});
        if (!filter) throw RenderError(fmt::format("Open Image Denoise {} makes no filter{}", version_, reason(device_)));
        // The filter reads around what it writes.
        std::vector<float> color = image.pixels;
        set_image(filter.get(), "color", image, color, *triple(image, {"R", "G", "B"}));
        set_image(filter.get(), "output", image, image.pixels, *triple(image, {"R", "G", "B"}));
        const auto albedo = triple(image, {"albedo.R", "albedo.G", "albedo.B"}), normal = triple(image, {"normal.X", "normal.Y", "normal.Z"});
        if (albedo) set_image(filter.get(), "albedo", image, color, *albedo);
        if (albedo && normal) set_image(filter.get(), "normal", image, color, *normal);  // the library takes it beside albedo alone
        api_.SetFilterBool(filter.get(), "hdr", true);
        api_.CommitFilter(filter.get());
        api_.ExecuteFilter(filter.get());
        if (const std::string why = reason(device_); !why.empty()) throw RenderError(fmt::format("Open Image Denoise {} cannot denoise a frame{}", version_, why));
    }

private:
    void set_image(oidn::Filter filter, const char* name, const Image& image, std::vector<float>& pixels, std::size_t first) const {
        const std::size_t stride = image.channels.size() * sizeof(float), width = static_cast<std::size_t>(image.width);
        api_.SetSharedFilterImage(filter, name, pixels.data(), oidn::kFloat3, width, static_cast<std::size_t>(image.height), first * sizeof(float), stride, stride * width);
    }

    /// ": what the library says", or nothing where it has no complaint. Asking clears it.
    std::string reason(oidn::Device device) const {
        const char* message = nullptr;
        if (api_.GetDeviceError(device, &message) == oidn::kNoError) return {};
        return fmt::format(": {}", message ? message : "no reason given");
    }

    oidn::Api api_;
    oidn::Device device_;
    std::string version_;
};

}  // namespace

std::unique_ptr<const Denoiser> open_oidn(const std::string& file) {
    void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!library) throw InputError(fmt::format("cannot open the denoiser: {}", dlerror()), kAdvice);
    oidn::Api api{};
    if (!find_all(library, api)) throw InputError(fmt::format("{} is not Open Image Denoise {}", file, kMajorVersion), kAdvice);
    return std::make_unique<OidnDenoiser>(api, file);
}

const Denoiser& oidn_denoiser() {
    static std::unique_ptr<const Denoiser> opened;
    if (opened) return *opened;
    const std::vector<std::string> files = candidates();
    for (std::size_t i = 0; i < files.size(); ++i) {
        try {
            opened = open_oidn(files[i]);
            return *opened;
        } catch (const InputError&) {
            if (i + 1 == files.size()) throw;
        }
    }
    std::abort();  // there is always a candidate
}

}  // namespace kadr
