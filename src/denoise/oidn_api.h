#pragma once

#include <cstddef>

// The part of Open Image Denoise's C interface that Kadr calls, as it stands in version 2 (include/OpenImageDenoise/oidn.h
// there). The library is opened when it is needed, so its header is not.

namespace kadr::oidn {

struct DeviceHandle;
struct FilterHandle;
using Device = DeviceHandle*;
using Filter = FilterHandle*;

enum DeviceType : int { kCpuDevice = 1 };
enum Format : int { kFloat3 = 3 };
enum Error : int { kNoError = 0 };

/// Addresses of the functions; the members have the library's own names less its prefix.
struct Api {
    Device (*NewDevice)(DeviceType type);
    void (*ReleaseDevice)(Device device);
    void (*CommitDevice)(Device device);
    void (*SetDeviceBool)(Device device, const char* name, bool value);
    int (*GetDeviceInt)(Device device, const char* name);
    Error (*GetDeviceError)(Device device, const char** message);
    Filter (*NewFilter)(Device device, const char* type);
    void (*ReleaseFilter)(Filter filter);
    /// The image stays the caller's. Strides are bytes; 0: tightly packed.
    void (*SetSharedFilterImage)(Filter filter, const char* name, void* values, Format format, std::size_t width,
                                 std::size_t height, std::size_t byte_offset, std::size_t pixel_stride,
                                 std::size_t row_stride);
    void (*SetFilterBool)(Filter filter, const char* name, bool value);
    void (*CommitFilter)(Filter filter);
    void (*ExecuteFilter)(Filter filter);
};

}  // namespace kadr::oidn
