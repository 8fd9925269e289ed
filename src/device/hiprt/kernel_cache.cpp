#include "device/hiprt/kernel_cache.h"

#include <algorithm>
#include <system_error>
#include <vector>

namespace kadr {
namespace {

namespace fs = std::filesystem;

struct Cached {
    fs::path path;
    fs::file_time_type written;
    std::uintmax_t bytes;
};

std::vector<Cached> newest_first(const fs::path& folder) {
    std::vector<Cached> files;
    std::error_code error;
    for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
        std::error_code gone;  // another process may clear up at the same time
        const Cached file{it->path(), it->last_write_time(gone), it->file_size(gone)};
        if (!gone) files.push_back(file);
    }
    std::sort(files.begin(), files.end(), [](const Cached& a, const Cached& b) { return a.written > b.written; });
    return files;
}

}  // namespace

fs::path prepare_kernel_cache(const fs::path& folder, std::uintmax_t most_bytes) {
    std::error_code error;
    fs::create_directories(folder, error);
    if (error) return {};
    std::uintmax_t bytes = 0;
    for (const Cached& file : newest_first(folder)) {
        bytes += file.bytes;
        std::error_code gone;
        if (bytes > most_bytes) fs::remove(file.path, gone);
    }
    return folder;
}

}  // namespace kadr
