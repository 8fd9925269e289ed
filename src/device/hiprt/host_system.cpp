#include "device/hiprt/host_system.h"

#include <dlfcn.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <system_error>

namespace kadr {
namespace {

namespace fs = std::filesystem;

class Machine final : public HostSystem {
public:
    bool can_open(const std::string& library) const override {
        // Never closed: drivers do not like to be opened twice.
        return dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL) != nullptr;
    }
    bool exports(const std::string& library, const char* function) const override {
        void* handle = dlopen(library.c_str(), RTLD_LAZY | RTLD_LOCAL);
        return handle && dlsym(handle, function);
    }
    std::optional<std::string> variable(const char* name) const override {
        const char* text = std::getenv(name);
        if (!text || !*text) return std::nullopt;
        return text;
    }
    bool exists(const fs::path& path) const override {
        std::error_code ignored;
        return fs::exists(path, ignored);
    }
    bool is_file(const fs::path& path) const override {
        std::error_code ignored;
        return fs::is_regular_file(path, ignored);
    }
    std::vector<fs::path> files_in(const fs::path& folder) const override {
        std::vector<fs::path> files;
        std::error_code error;
        for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error))
            files.push_back(it->path());
        std::sort(files.begin(), files.end());
        return files;
    }
    std::string text_of(const fs::path& file) const override {
        std::ifstream stream(file, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    fs::path program_folder() const override {
        std::error_code ignored;
        return fs::read_symlink("/proc/self/exe", ignored).parent_path();
    }
};

}  // namespace

const HostSystem& this_machine() {
    static const Machine machine;
    return machine;
}

}  // namespace kadr
