#pragma once

#include <map>
#include <set>
#include <string>

#include "device/hiprt/host_system.h"

namespace kadr::test {

/// A machine on which there is what a test says, and which notes what was opened.
class FakeMachine : public HostSystem {
public:
    std::set<std::string> libraries, nodes, functions;
    std::map<std::string, std::string> variables, files;  ///< files: path -> text
    mutable std::vector<std::string> opened;              ///< every name that was tried

    bool can_open(const std::string& library) const override {
        opened.push_back(library);
        return libraries.count(library) > 0;
    }
    bool exports(const std::string& library, const char* function) const override {
        return libraries.count(library) > 0 && functions.count(function) > 0;
    }
    std::optional<std::string> variable(const char* name) const override {
        const auto found = variables.find(name);
        if (found == variables.end() || found->second.empty()) return std::nullopt;
        return found->second;
    }
    bool exists(const std::filesystem::path& path) const override {
        return nodes.count(path.string()) > 0 || is_file(path);
    }
    bool is_file(const std::filesystem::path& path) const override {
        return files.count(path.lexically_normal().string()) > 0;
    }
    std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder) const override {
        std::vector<std::filesystem::path> found;
        const std::filesystem::path wanted = (folder / "x").lexically_normal().parent_path();
        for (const auto& [path, text] : files)
            if (std::filesystem::path(path).parent_path() == wanted) found.emplace_back(path);
        return found;
    }
    std::string text_of(const std::filesystem::path& file) const override {
        const auto found = files.find(file.lexically_normal().string());
        return found == files.end() ? "" : found->second;
    }
    std::filesystem::path program_folder() const override { return "/opt/kadr/bin"; }
};

/// A machine with an NVIDIA card on which nothing is missing.
inline FakeMachine nvidia_machine() {
    FakeMachine machine;
    machine.nodes = {"/dev/nvidiactl"};
    machine.libraries = {"libcuda.so.1", "libcudart.so", "libnvrtc.so"};
    machine.functions = {"cudaGetDeviceProperties_v2"};
    machine.variables = {{"HIPRT_ROOT", "/opt/hiprt31"}};
    machine.files = {{"/opt/hiprt31/lib/libhiprt0300164.so", ""},
                     {"/opt/hiprt31/include/hiprt/hiprt.h", "#define HIPRT_API_VERSION 3001\n"},
                     {"/opt/hiprt31/include/hiprt/impl/hiprt_device_impl.h", ""},
                     {"/opt/kadr/share/kadr/kernels/gpu/launch_params.h", ""}};
    return machine;
}

/// A machine with an AMD card on which nothing is missing.
inline FakeMachine amd_machine() {
    FakeMachine machine = nvidia_machine();
    machine.nodes = {"/dev/kfd"};
    machine.libraries = {"libamdhip64.so.6", "/opt/rocm/lib/libhiprtc.so"};
    return machine;
}

}  // namespace kadr::test
