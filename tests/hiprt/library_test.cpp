// libhiprt is found where it should be, and refused by name where it is not ours.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "device/hiprt/hiprt_library.h"
#include "fake_machine.h"

namespace kadr {
namespace {

using test::FakeMachine;
using ::testing::HasSubstr;

std::string found(const FakeMachine& machine) {
    const Found<std::filesystem::path> result = find_hiprt_library(machine);
    return std::holds_alternative<std::filesystem::path>(result) ? std::get<std::filesystem::path>(result).string()
                                                                 : "";
}

std::string refusal(const FakeMachine& machine) {
    const Found<std::filesystem::path> result = find_hiprt_library(machine);
    return std::holds_alternative<std::string>(result) ? std::get<std::string>(result) : "";
}

TEST(HiprtLibrary, NamesTellVersions) {
    EXPECT_EQ(api_version_of("/a/libhiprt0300164.so"), 3001u);
    EXPECT_EQ(api_version_of("libhiprt0200564.so"), 2005u);
    EXPECT_EQ(api_version_of("hiprt0300164.so"), 3001u);
    EXPECT_EQ(api_version_of("libhiprt.so"), std::nullopt);
    EXPECT_EQ(api_version_of("libhiprt03001.so"), std::nullopt);
    EXPECT_EQ(api_version_of("libother0300164.so"), std::nullopt);
}

TEST(HiprtLibrary, TheVariableComesFirstAndIsTakenOrRefused) {
    FakeMachine machine = test::nvidia_machine();
    machine.variables["KADR_HIPRT_LIBRARY"] = "/mine/any_name.so";
    EXPECT_EQ(refusal(machine),
              "KADR_HIPRT_LIBRARY is /mine/any_name.so, which is not a file; set it to libhiprt0300164.so, or leave it "
              "unset");
    machine.files["/mine/any_name.so"] = "";
    EXPECT_EQ(found(machine), "/mine/any_name.so");  // what its name does not tell, hiprtCreateContext does
    machine.files["/mine/libhiprt0200564.so"] = "";
    machine.variables["KADR_HIPRT_LIBRARY"] = "/mine/libhiprt0200564.so";
    EXPECT_EQ(refusal(machine),
              "/mine/libhiprt0200564.so is HIPRT's API 2005, but this program works with 3001 only; install HIPRT 3.1 "
              "(libhiprt0300164.so)");
}

TEST(HiprtLibrary, EveryFolderOfTheRoot) {
    for (const char* folder : {"lib", "lib64", "bin"}) {
        FakeMachine machine;
        machine.variables["HIPRT_ROOT"] = "/opt/hiprt";
        const std::string file = std::string("/opt/hiprt/") + folder + "/libhiprt0300164.so";
        machine.files[file] = "";
        EXPECT_EQ(found(machine), file);
    }
}

TEST(HiprtLibrary, OursBeforeOthersOfTheSameRoot) {
    FakeMachine machine;
    machine.variables["HIPRT_ROOT"] = "/opt/hiprt";
    machine.files = {{"/opt/hiprt/lib/libhiprt0300264.so", ""}, {"/opt/hiprt/lib/libhiprt.so", ""}};
    EXPECT_EQ(found(machine), "/opt/hiprt/lib/libhiprt.so");
    machine.files["/opt/hiprt/bin/libhiprt0300164.so"] = "";
    machine.files.erase("/opt/hiprt/lib/libhiprt.so");
    EXPECT_EQ(found(machine), "/opt/hiprt/bin/libhiprt0300164.so");
    machine.files.erase("/opt/hiprt/bin/libhiprt0300164.so");
    EXPECT_THAT(refusal(machine), HasSubstr("/opt/hiprt/lib/libhiprt0300264.so is HIPRT's API 3002"));
}

TEST(HiprtLibrary, AnEmptyRootIsNotPassedOver) {
    FakeMachine machine;
    machine.variables["HIPRT_ROOT"] = "/opt/empty";
    machine.libraries = {"libhiprt0300164.so"};  // the loader would find one
    EXPECT_EQ(refusal(machine),
              "HIPRT_ROOT is /opt/empty, but neither its lib nor its bin folder holds libhiprt0300164.so; set it to "
              "the folder "
              "that HIPRT 3.1 was unpacked to");
}

TEST(HiprtLibrary, TheUsualPlaces) {
    FakeMachine machine;
    machine.files["/usr/local/lib/libhiprt0200564.so"] = "";
    EXPECT_THAT(refusal(machine), HasSubstr("/usr/local/lib/libhiprt0200564.so is HIPRT's API 2005"));
    machine.files["/opt/hiprt/lib/libhiprt0300164.so"] = "";
    EXPECT_EQ(found(machine), "/opt/hiprt/lib/libhiprt0300164.so");
    machine.libraries = {"libhiprt0300164.so"};
    EXPECT_EQ(found(machine), "libhiprt0300164.so");
}

TEST(HiprtLibrary, OpensOne) {
    const HiprtLibrary library = HiprtLibrary::open(KADR_WHOLE_LIBRARY);
    const hiprt::Api& api = library.api();
    hiprt::Context context = nullptr;
    EXPECT_EQ(api.create_context(hiprt::kApiVersion, {}, context), hiprt::Error::invalid_api_version);
    EXPECT_NE(api.build_trace_kernels, nullptr);
    EXPECT_EQ(library.file(), KADR_WHOLE_LIBRARY);
}

TEST(HiprtLibrary, NamesAnEntryPointThatIsMissing) {
    try {
        HiprtLibrary::open(KADR_PARTIAL_LIBRARY);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("has no hiprtBuildTraceKernels"));
    }
}

TEST(HiprtLibrary, SaysWhyAFileCannotBeOpened) {
    try {
        HiprtLibrary::open(__FILE__);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("library_test.cpp cannot be opened: "));
    }
}

}  // namespace
}  // namespace kadr
