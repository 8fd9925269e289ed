// Stands in for Open Image Denoise: the functions that Kadr calls, with the library's names. It checks what it is given
// as the library would, and "denoises" by color + 2 albedo + 3 normal, so that a test sees which values arrived.

#include <cstddef>
#include <cstring>
#include <map>
#include <string>

namespace {

struct Picture {
    char* values = nullptr;
    std::size_t width = 0, height = 0, offset = 0, pixel_stride = 0, row_stride = 0;
    float& at(std::size_t x, std::size_t y, std::size_t c) const {
        return *reinterpret_cast<float*>(values + offset + y * row_stride + x * pixel_stride + c * sizeof(float));
    }
};

struct FakeDevice {
    bool committed = false, affinity = true;
    std::string error;
};

struct FakeFilter {
    FakeDevice* device;
    std::map<std::string, Picture> pictures;
    bool hdr = false, committed = false;
};

FakeDevice the_device;

void refuse(FakeDevice* device, const char* why) {
    if (device->error.empty()) device->error = why;
}

}  // namespace

extern "C" {

void* oidnNewDevice(int type) { return type == 1 ? &the_device : nullptr; }
void oidnReleaseDevice(void*) {}
void oidnSetDeviceBool(void* device, const char* name, bool value) {
    if (std::strcmp(name, "setAffinity") == 0) static_cast<FakeDevice*>(device)->affinity = value;
}
void oidnCommitDevice(void* device) {
    auto* own = static_cast<FakeDevice*>(device);
    own->committed = true;
    if (own->affinity) refuse(own, "threads are bound to cores");
}
int oidnGetDeviceInt(void*, const char* name) { return std::strcmp(name, "version") == 0 ? KADR_FAKE_VERSION : 0; }
int oidnGetDeviceError(void* device, const char** message) {
    static std::string said;
    auto* own = static_cast<FakeDevice*>(device);
    if (!own || own->error.empty()) return 0;
    said = own->error;
    own->error.clear();
    *message = said.c_str();
    return 1;
}
void* oidnNewFilter(void* device, const char* type) {
    auto* own = static_cast<FakeDevice*>(device);
    if (!own->committed || std::strcmp(type, "RT") != 0) return nullptr;
    return new FakeFilter{own, {}, false, false};
}
void oidnReleaseFilter(void* filter) { delete static_cast<FakeFilter*>(filter); }
void oidnSetSharedFilterImage(void* filter, const char* name, void* values, int format, std::size_t width, std::size_t height,
                              std::size_t byte_offset, std::size_t pixel_stride, std::size_t row_stride) {
    auto* own = static_cast<FakeFilter*>(filter);
    if (format != 3) refuse(own->device, "not a picture of three floats");
    own->pictures[name] = {static_cast<char*>(values), width, height, byte_offset, pixel_stride, row_stride};
}
void oidnSetFilterBool(void* filter, const char* name, bool value) {
    if (std::strcmp(name, "hdr") == 0) static_cast<FakeFilter*>(filter)->hdr = value;
}
void oidnCommitFilter(void* filter) {
    auto* own = static_cast<FakeFilter*>(filter);
    own->committed = true;
    if (!own->hdr) refuse(own->device, "linear radiance is not LDR");
    if (!own->pictures.contains("color") || !own->pictures.contains("output")) refuse(own->device, "no picture");
    if (own->pictures.contains("normal") && !own->pictures.contains("albedo")) refuse(own->device, "normal without albedo");
}
void oidnExecuteFilter(void* filter) {
    auto* own = static_cast<FakeFilter*>(filter);
#ifdef KADR_FAKE_REFUSES
    return refuse(own->device, "out of memory");
#endif
    if (!own->committed) return refuse(own->device, "not committed");
    const Picture color = own->pictures["color"], output = own->pictures["output"];
    if (color.values == output.values) return refuse(own->device, "reads what it writes");
    for (std::size_t y = 0; y < color.height; ++y)
        for (std::size_t x = 0; x < color.width; ++x)
            for (std::size_t c = 0; c < 3; ++c) {
                float value = color.at(x, y, c);
                if (own->pictures.contains("albedo")) value += 2 * own->pictures["albedo"].at(x, y, c);
                if (own->pictures.contains("normal")) value += 3 * own->pictures["normal"].at(x, y, c);
                output.at(x, y, c) = value;
            }
}

}  // extern "C"
