// A shared library that exports the entry points of HIPRT that we use; each reports the error of another API version.
// It is opened by library_test.cpp and never asked to do anything.

#include "device/hiprt/hiprt_abi.h"

using kadr::hiprt::Error;

extern "C" {
Error hiprtCreateContext() { return Error::invalid_api_version; }
Error hiprtDestroyContext() { return Error::invalid_api_version; }
Error hiprtSetLogLevel() { return Error::invalid_api_version; }
Error hiprtSetCacheDirPath() { return Error::invalid_api_version; }
Error hiprtCreateGeometries() { return Error::invalid_api_version; }
Error hiprtDestroyGeometry() { return Error::invalid_api_version; }
Error hiprtGetGeometriesBuildTemporaryBufferSize() { return Error::invalid_api_version; }
Error hiprtBuildGeometries() { return Error::invalid_api_version; }
Error hiprtCompactGeometries() { return Error::invalid_api_version; }
Error hiprtCreateScene() { return Error::invalid_api_version; }
Error hiprtDestroyScene() { return Error::invalid_api_version; }
Error hiprtGetSceneBuildTemporaryBufferSize() { return Error::invalid_api_version; }
Error hiprtBuildScene() { return Error::invalid_api_version; }
Error hiprtCreateFuncTable() { return Error::invalid_api_version; }
Error hiprtSetFuncTable() { return Error::invalid_api_version; }
Error hiprtDestroyFuncTable() { return Error::invalid_api_version; }
#ifndef KADR_WITHOUT_TRACE_KERNELS
Error hiprtBuildTraceKernels() { return Error::invalid_api_version; }
#endif
}
