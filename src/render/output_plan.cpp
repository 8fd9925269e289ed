#include "render/output_plan.h"

#include <cerrno>
#include <cstring>
#include <set>
#include <system_error>
#include <unistd.h>

#include <fmt/format.h>

#include "output/frame_writer.h"

namespace kadr {
namespace fs = std::filesystem;

namespace {

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

fs::path nearest_existing(fs::path folder) {
    std::error_code ignored;
    while (!fs::exists(folder, ignored) && folder.has_parent_path() && folder != folder.parent_path())
        folder = folder.parent_path();
    return folder;
}

}  // namespace

std::vector<fs::path> frame_files(const OutputSpec& output, int frame) {
    std::vector<fs::path> files;
    for (const std::string& pattern : output.frames) files.push_back(frame_path(pattern, frame));
    return files;
}

std::vector<fs::path> output_folders(const OutputSpec& output, const std::vector<int>& frames) {
    std::set<fs::path> folders;
    for (const int frame : frames)
        for (const fs::path& file : frame_files(output, frame)) folders.insert(folder_of(file));
    if (output.video) folders.insert(folder_of(output.video->file));
    return {folders.begin(), folders.end()};
}

std::vector<Diagnostic> colliding_patterns(const OutputSpec& output, const std::vector<int>& frames) {
    std::vector<Diagnostic> problems;
    if (frames.size() < 2) return problems;
    for (std::size_t i = 0; i < output.frames.size(); ++i) {
        const std::string& pattern = output.frames[i];
        if (frame_path(pattern, frames[0]) != frame_path(pattern, frames[1])) continue;
        Diagnostic problem;
        if (i < output.frames_where.size()) problem.where = output.frames_where[i];
        problem.found = fmt::format("output.frames gives {} frames one file, {}", frames.size(), pattern);
        problem.expected = "write the frame's number as {frame:04}";
        problems.push_back(std::move(problem));
    }
    return problems;
}

std::string why_not_writable(const fs::path& folder) {
    const fs::path existing = nearest_existing(folder);
    std::error_code ignored;
    if (!fs::is_directory(existing, ignored)) return fmt::format("{} is not a folder", existing.string());
    if (access(existing.c_str(), W_OK) != 0) return fmt::format("{}: {}", existing.string(), std::strerror(errno));
    return {};
}

void prepare_folders(const std::vector<fs::path>& folders) {
    for (const fs::path& folder : folders) {
        const std::string reason = why_not_writable(folder);
        std::error_code failed;
        if (reason.empty()) fs::create_directories(folder, failed);
        if (!reason.empty() || failed)
            throw RenderError(fmt::format("cannot write to the folder {}: {}", folder.string(),
                                          reason.empty() ? failed.message() : reason));
        remove_leftovers(folder);
    }
}

}  // namespace kadr
