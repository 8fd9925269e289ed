#include "fake_hiprt.h"

#include <cmath>
#include <cstring>
#include <mutex>

#include <fmt/format.h>
#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "frame/decompose.h"
#include "kernels/gpu/launch_params.h"

namespace kadr::test {
namespace {

using hiprt::Error;

/// Those that there are, by their runtimes' contexts: the library has functions only.
std::map<void*, FakeHiprt*>& fakes() {
    static std::map<void*, FakeHiprt*> all;
    return all;
}

std::uintptr_t number_of(const void* pointer) { return reinterpret_cast<std::uintptr_t>(pointer); }

template <class T>
std::vector<T> read(const void* from, std::size_t count) {
    std::vector<T> values(count);
    std::memcpy(values.data(), from, count * sizeof(T));
    return values;
}

std::size_t primitives_of(const hiprt::GeometryBuildInput& input) {
    return input.type == hiprt::PrimitiveType::aabb_list ? input.list.box_count : input.mesh.triangle_count;
}

/// What sizes are asked for, and builds recognised, by.
std::pair<void*, std::size_t> key_of(const hiprt::GeometryBuildInput& input) {
    const bool boxes = input.type == hiprt::PrimitiveType::aabb_list;
    return {boxes ? input.list.boxes : input.mesh.vertices, primitives_of(input)};
}

std::vector<Range> inputs_of(const hiprt::GeometryBuildInput& input) {
    if (input.type == hiprt::PrimitiveType::aabb_list)
        return {{number_of(input.list.boxes), std::size_t{input.list.box_count} * input.list.box_stride}};
    const hiprt::TriangleMesh& mesh = input.mesh;
    return {{number_of(mesh.vertices), std::size_t{mesh.vertex_count} * mesh.vertex_stride},
            {number_of(mesh.indices), std::size_t{mesh.triangle_count} * mesh.triangle_stride}};
}

/// A structure leads to what rays fetch through it: the recording runtime follows addresses.
void note_inputs(hiprt::Geometry geometry, const hiprt::GeometryBuildInput& input) {
    const bool boxes = input.type == hiprt::PrimitiveType::aabb_list;
    const void* const inputs[] = {boxes ? input.list.boxes : input.mesh.vertices, boxes ? nullptr : input.mesh.indices};
    std::memcpy(reinterpret_cast<void*>(geometry), inputs, sizeof inputs);
}

struct Pose {
    glm::dquat rotation;
    glm::dvec3 scale, shear;
    float time;
    bool finite;
};

bool all_finite(const float* values, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        if (!std::isfinite(values[i])) return false;
    return true;
}

Pose pose_of(const kernels::FrameSrt& f) {
    Pose pose{};
    pose.finite = all_finite(&f.axis[0], 11);
    pose.time = f.time;
    const glm::dvec3 axis(f.axis[0], f.axis[1], f.axis[2]);
    pose.rotation = glm::length(axis) > 0 ? glm::angleAxis(static_cast<double>(f.angle), glm::normalize(axis))
                                          : glm::dquat(1, 0, 0, 0);
    pose.scale = {f.scale[0], f.scale[1], f.scale[2]};
    if (glm::length(axis) == 0 && f.angle != 0) pose.finite = false;  // HIPRT makes NaN of it
    if (std::abs(f.angle) > 3.1415928f) pose.finite = false;
    return pose;
}

Pose pose_of(const kernels::FrameMatrix& f) {
    Pose pose{};
    pose.finite = all_finite(&f.matrix[0][0], 12) && std::isfinite(f.time);
    pose.time = f.time;
    if (!pose.finite) return pose;
    glm::dmat4 m(1);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) m[column][row] = f.matrix[row][column];
    if (glm::determinant(glm::dmat3(m)) == 0) return pose;  // scale 0 is reported
    const Decomposition d = decompose(m);
    pose.rotation = d.rotation;
    pose.scale = d.scale;
    pose.shear = d.shear;
    return pose;
}

}  // namespace

/// One call into a context. HIPRT's context is for one thread at a time.
class Entered {
public:
    Entered(std::recursive_mutex& inside, RecordingRuntime& runtime)
        : call_(inside, std::try_to_lock), locked_(runtime.lock()) {
        if (!call_.owns_lock()) runtime.fault("hiprt: a context is used by two threads at once");
    }

private:
    std::unique_lock<std::recursive_mutex> call_;
    std::unique_lock<std::recursive_mutex> locked_;
};

struct FakeEntryPoints {
    static Error create_context(std::uint32_t version, const hiprt::ContextCreationInput& input,
                                hiprt::Context& context) {
        const auto known = fakes().find(input.context);
        if (known == fakes().end()) return Error::invalid_parameter;
        FakeHiprt& f = *known->second;
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("create_context")) return Error::internal;
        if (version != hiprt::kApiVersion) return Error::invalid_api_version;
        f.runtime_.expect_current("create_context");
        const bool amd = f.runtime_.vendor == GpuVendor::amd;
        if (input.device_type != (amd ? hiprt::DeviceType::amd : hiprt::DeviceType::nvidia))
            f.fault("create_context: not the runtime's vendor");
        if (f.has_context) f.fault("create_context: there is one already");
        f.has_context = true;
        context = reinterpret_cast<hiprt::Context>(&f);
        return Error::success;
    }

    /// The fake of a context; a call without one is a fault.
    static FakeHiprt& of(hiprt::Context context, const char* call) {
        FakeHiprt* fake = nullptr;
        for (const auto& [native, one] : fakes())
            if (reinterpret_cast<hiprt::Context>(one) == context) fake = one;
        if (!fake) fake = fakes().begin()->second;
        if (reinterpret_cast<hiprt::Context>(fake) != context || !fake->has_context)
            fake->fault(std::string(call) + ": no such context");
        fake->runtime_.expect_current(call);
        return *fake;
    }

    static Error destroy_context(hiprt::Context context) {
        FakeHiprt& f = of(context, "destroy_context");
        const Entered entered(f.inside_, f.runtime_);
        const bool fails = f.runtime_.begin_call("destroy_context");
        for (const std::string& leak : f.leaks())
            if (leak != "a context") f.fault("destroy_context: there is still " + leak);
        f.has_context = false;
        f.modules.clear();
        return fails ? Error::internal : Error::success;
    }

    static Error set_log_level(hiprt::Context context, std::uint32_t level) {
        FakeHiprt& f = of(context, "set_log_level");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("set_log_level")) return Error::internal;
        f.log_level = level;
        return Error::success;
    }

    static Error set_cache_path(hiprt::Context context, const char* path) {
        FakeHiprt& f = of(context, "set_cache_path");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("set_cache_path")) return Error::internal;
        f.cache_path = path;
        return Error::success;
    }

    static Error create_geometries(hiprt::Context context, std::uint32_t count, const hiprt::GeometryBuildInput* inputs,
                                   hiprt::BuildOptions options, hiprt::Geometry** created) {
        FakeHiprt& f = of(context, "create_geometries");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("create_geometries")) return Error::internal;
        if (count == 0 || !inputs || !created) return Error::invalid_parameter;
        f.check_options(options);
        for (std::uint32_t i = 0; i < count; ++i) {
            f.check_mesh(inputs[i], options);
            const std::size_t bytes =
                256 + inputs[i].mesh.triangle_count *
                          f.bytes_per_triangle_of[options.flags & hiprt::build_flag::kQualityMask];
            const DeviceAddress address = f.take(bytes);
            if (address == 0) {
                for (std::uint32_t k = 0; k < i; ++k) {
                    f.give_back(*created[k]);
                    f.geometries.erase(*created[k]);
                    *created[k] = nullptr;
                }
                return Error::internal;  // as HIPRT does
            }
            *created[i] = reinterpret_cast<hiprt::Geometry>(address);
            f.geometries[*created[i]] = {inputs[i], options, bytes, false, false, 0, {}};
        }
        return Error::success;
    }

    static Error destroy_geometry(hiprt::Context context, hiprt::Geometry geometry) {
        FakeHiprt& f = of(context, "destroy_geometry");
        const Entered entered(f.inside_, f.runtime_);
        const bool fails = f.runtime_.begin_call("destroy_geometry");
        const auto found = f.geometries.find(geometry);
        if (found == f.geometries.end()) {
            f.fault("destroy_geometry: no such geometry, or destroyed before");
            return Error::invalid_parameter;
        }
        for (const auto& [handle, scene] : f.scenes)
            for (const hiprt::Instance& instance : scene.instances)
                if (scene.built && instance.geometry == geometry) {
                    f.fault("destroy_geometry: a scene still shows it");
                    break;
                }
        if (f.runtime_.is_pending({number_of(geometry), found->second.bytes}))
            f.fault("destroy_geometry: work on it is pending");
        f.give_back(geometry);
        f.geometries.erase(found);
        return fails ? Error::internal : Error::success;
    }

    static Error geometries_temporary_size(hiprt::Context context, std::uint32_t count,
                                           const hiprt::GeometryBuildInput* inputs, hiprt::BuildOptions options,
                                           std::size_t& bytes) {
        FakeHiprt& f = of(context, "geometries_temporary_size");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("geometries_temporary_size")) return Error::internal;
        if (count == 0 || !inputs) return Error::invalid_parameter;
        f.check_options(options);
        bytes = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            f.check_mesh(inputs[i], options);
            const std::size_t own = 64 + primitives_of(inputs[i]) * f.temporary_per_primitive;
            f.geometry_sizes_[key_of(inputs[i])] = {options, own};
            bytes = std::max(bytes, own);
        }
        return Error::success;
    }

    static Error build_geometries(hiprt::Context context, hiprt::BuildOperation operation, std::uint32_t count,
                                  const hiprt::GeometryBuildInput* inputs, hiprt::BuildOptions options,
                                  hiprt::DevicePointer temporary, hiprt::Stream stream, hiprt::Geometry* geometries) {
        FakeHiprt& f = of(context, "build_geometries");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("build_geometries")) return Error::internal;
        if (count == 0 || !inputs || !geometries) return Error::invalid_parameter;
        f.check_options(options);
        for (std::uint32_t i = 0; i < count; ++i) {
            f.check_mesh(inputs[i], options);
            const auto found = f.geometries.find(geometries[i]);
            if (found == f.geometries.end()) {
                f.fault("build_geometries: no such geometry");
                return Error::invalid_parameter;
            }
            FakeHiprt::GeometryRecord& record = found->second;
            if (!(record.options == options)) f.fault("build_geometries: other flags than it was created with");
            if (inputs[i].type != record.input.type || primitives_of(inputs[i]) != primitives_of(record.input))
                f.fault("build_geometries: another size than it was created for");
            std::vector<Range> writes = {{number_of(geometries[i]), record.bytes}};
            if (operation == hiprt::BuildOperation::build) {
                const auto size = f.geometry_sizes_.find(key_of(inputs[i]));
                if (size == f.geometry_sizes_.end() || !(size->second.options == options))
                    f.fault("build_geometries: its temporary size was never asked for with these flags");
                else {
                    f.runtime_.expect_device({number_of(temporary), size->second.bytes},
                                             "build_geometries' temporary buffer");
                    writes.push_back({number_of(temporary), size->second.bytes});
                }
            }
            f.runtime_.enqueue(stream, "build_geometries", inputs_of(inputs[i]), std::move(writes), [&f, geometry = geometries[i], input = inputs[i], operation] {
                f.run_geometry_build(geometry, input, operation);
            });
        }
        return Error::success;
    }

    static Error compact_geometries(hiprt::Context context, std::uint32_t count, hiprt::Stream stream,
                                    hiprt::Geometry* in, hiprt::Geometry** out) {
        FakeHiprt& f = of(context, "compact_geometries");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("compact_geometries")) return Error::internal;
        if (count == 0 || !in || !out) return Error::invalid_parameter;
        for (std::uint32_t i = 0; i < count; ++i)
            if (f.runtime_.is_pending({number_of(in[i]), 1})) f.fault("compact_geometries: it is still being built");
        f.runtime_.run_all(stream);
        for (std::uint32_t i = 0; i < count; ++i) {
            const auto found = f.geometries.find(in[i]);
            if (found == f.geometries.end() || !found->second.built) {
                f.fault("compact_geometries: it was never built");
                return Error::invalid_parameter;
            }
            FakeHiprt::GeometryRecord record = found->second;
            record.bytes = record.bytes / 2 + 1;
            record.compacted = true;
            const DeviceAddress address = f.take(record.bytes);
            if (address == 0) return Error::internal;
            f.give_back(in[i]);
            f.geometries.erase(found);
            *out[i] = reinterpret_cast<hiprt::Geometry>(address);
            f.geometries[*out[i]] = record;
            note_inputs(*out[i], record.input);
        }
        return Error::success;
    }

    static Error create_scene(hiprt::Context context, const hiprt::SceneBuildInput& input, hiprt::BuildOptions options,
                              hiprt::Scene& created) {
        FakeHiprt& f = of(context, "create_scene");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("create_scene")) return Error::internal;
        f.check_options(options);
        if (input.instance_count == 0) f.fault("create_scene: no instances");
        if (input.instance_count > hiprt::kMostInstances) return Error::internal;
        const std::size_t bytes = 256 + input.instance_count * f.bytes_per_instance + input.frame_count * 64;
        const DeviceAddress address = f.take(bytes);
        if (address == 0) return Error::internal;
        created = reinterpret_cast<hiprt::Scene>(address);
        f.scenes[created].created_for = input;
        f.scenes[created].options = options;
        f.scenes[created].bytes = bytes;
        return Error::success;
    }

    static Error destroy_scene(hiprt::Context context, hiprt::Scene scene) {
        FakeHiprt& f = of(context, "destroy_scene");
        const Entered entered(f.inside_, f.runtime_);
        const bool fails = f.runtime_.begin_call("destroy_scene");
        const auto found = f.scenes.find(scene);
        if (found == f.scenes.end()) {
            f.fault("destroy_scene: no such scene, or destroyed before");
            return Error::invalid_parameter;
        }
        if (f.runtime_.is_pending({number_of(scene), found->second.bytes}))
            f.fault("destroy_scene: work on it is pending");
        f.give_back(scene);
        f.scenes.erase(found);
        return fails ? Error::internal : Error::success;
    }

    static Error scene_temporary_size(hiprt::Context context, const hiprt::SceneBuildInput& input,
                                      hiprt::BuildOptions options, std::size_t& bytes) {
        FakeHiprt& f = of(context, "scene_temporary_size");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("scene_temporary_size")) return Error::internal;
        f.check_options(options);
        bytes = 64 + input.instance_count * f.temporary_per_primitive;
        f.scene_sizes_[{input.instance_count, input.frame_count}] = {options, bytes};
        return Error::success;
    }

    static Error build_scene(hiprt::Context context, hiprt::BuildOperation operation,
                             const hiprt::SceneBuildInput& input, hiprt::BuildOptions options,
                             hiprt::DevicePointer temporary, hiprt::Stream stream, hiprt::Scene scene) {
        FakeHiprt& f = of(context, "build_scene");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("build_scene")) return Error::internal;
        f.check_options(options);
        const auto found = f.scenes.find(scene);
        if (found == f.scenes.end()) {
            f.fault("build_scene: no such scene");
            return Error::invalid_parameter;
        }
        const FakeHiprt::SceneRecord& record = found->second;
        if (operation != hiprt::BuildOperation::build) f.fault("build_scene: an update is a race for static instances");
        if (!(record.options == options)) f.fault("build_scene: other flags than it was created with");
        if (record.created_for.instance_count != input.instance_count ||
            record.created_for.frame_count != input.frame_count || record.created_for.frame_type != input.frame_type)
            f.fault("build_scene: another size than it was created for");
        const auto size = f.scene_sizes_.find({input.instance_count, input.frame_count});
        if (size == f.scene_sizes_.end() || !(size->second.options == options)) {
            f.fault("build_scene: its temporary size was never asked for with these flags");
            return Error::invalid_parameter;
        }
        const std::size_t frame = input.frame_type == hiprt::FrameType::srt ? 48 : 64;
        std::vector<Range> writes = {{number_of(scene), record.bytes}, {number_of(temporary), size->second.bytes}},
                           reads = {{number_of(input.instances), input.instance_count * sizeof(hiprt::Instance)},
                                    {number_of(input.headers), input.instance_count * sizeof(kernels::TransformHeader)},
                                    {number_of(input.frames), input.frame_count * frame},
                                    {number_of(input.masks), input.instance_count * sizeof(std::uint32_t)}};
        bool right = true;
        for (const std::vector<Range>& ranges : {writes, reads})
            for (const Range& range : ranges) right = f.runtime_.expect_device(range, "build_scene") && right;
        if (!right) return Error::invalid_parameter;
        f.runtime_.enqueue(stream, "build_scene", std::move(reads), std::move(writes), [&f, scene, input] { f.run_scene_build(scene, input); });
        return Error::success;
    }

    static Error create_function_table(hiprt::Context context, std::uint32_t geometry_types, std::uint32_t ray_types,
                                       hiprt::FunctionTable& created) {
        FakeHiprt& f = of(context, "create_function_table");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("create_function_table")) return Error::internal;
        if (geometry_types == 0 || ray_types == 0) return Error::invalid_parameter;
        const DeviceAddress address = f.take(64);
        if (address == 0) return Error::internal;
        created = reinterpret_cast<hiprt::FunctionTable>(address);
        f.tables.insert(created);
        return Error::success;
    }

    static Error set_function_table(hiprt::Context context, hiprt::FunctionTable table, std::uint32_t geometry_type,
                                    std::uint32_t ray_type, hiprt::FunctionData) {
        FakeHiprt& f = of(context, "set_function_table");
        const Entered entered(f.inside_, f.runtime_);
        if (f.runtime_.begin_call("set_function_table")) return Error::internal;
        if (f.tables.count(table) == 0 || geometry_type >= kernels::geometry_type::kCount || ray_type != 0)
            f.fault("set_function_table: no such entry");
        return Error::success;
    }

    static Error destroy_function_table(hiprt::Context context, hiprt::FunctionTable table) {
        FakeHiprt& f = of(context, "destroy_function_table");
        const Entered entered(f.inside_, f.runtime_);
        const bool fails = f.runtime_.begin_call("destroy_function_table");
        if (f.tables.erase(table) == 0) {
            f.fault("destroy_function_table: no such table");
            return Error::invalid_parameter;
        }
        f.give_back(table);
        return fails ? Error::internal : Error::success;
    }

    static Error build_trace_kernels(hiprt::Context context, std::uint32_t function_count, const char** names,
                                     const char* source, const char* module_name, std::uint32_t header_count,
                                     const char**, const char**, std::uint32_t option_count, const char** options,
                                     std::uint32_t geometry_types, std::uint32_t ray_types,
                                     hiprt::FunctionNames* function_names, hiprt::Function* functions, hiprt::Module*,
                                     bool) {
        FakeHiprt& f = of(context, "build_trace_kernels");
        if (f.while_compiling) f.while_compiling();
        const auto locked = f.runtime_.lock();
        if (f.runtime_.begin_call("build_trace_kernels")) return Error::internal;
        if (function_count == 0 || !names || !source || !module_name || !functions) return Error::invalid_parameter;
        if (header_count != 0) f.fault("build_trace_kernels: headers come from folders");
        if ((f.log_level & hiprt::log_level::kErrors) == 0)
            f.fault("build_trace_kernels: compile errors would not be seen");
        if (geometry_types * ray_types != 0 && !function_names) f.fault("build_trace_kernels: functions without names");
        FakeHiprt::ModuleRecord module{source, {}, {}};
        for (std::uint32_t i = 0; i < geometry_types * ray_types; ++i)
            for (const char* name : {function_names[i].intersect, function_names[i].filter})
                module.functions.emplace_back(name ? name : "");
        for (std::uint32_t i = 0; i < option_count; ++i) module.options.emplace_back(options[i]);
        // The library keeps modules by their name alone.
        const auto [at, is_new] = f.modules.emplace(module_name, module);
        if (!is_new && (at->second.source != module.source || at->second.options != module.options ||
                        at->second.functions != module.functions))
            f.fault("build_trace_kernels: one module name for two sources");
        for (std::uint32_t i = 0; i < function_count; ++i) functions[i] = f.runtime_.make_function(names[i]);
        return Error::success;
    }
};

FakeHiprt::FakeHiprt(RecordingRuntime& runtime) : runtime_(runtime) { fakes()[runtime.native_context()] = this; }
FakeHiprt::~FakeHiprt() { fakes().erase(runtime_.native_context()); }

hiprt::Api FakeHiprt::api() {
    using E = FakeEntryPoints;
    return {E::create_context,
            E::destroy_context,
            E::set_log_level,
            E::set_cache_path,
            E::create_geometries,
            E::destroy_geometry,
            E::geometries_temporary_size,
            E::build_geometries,
            E::compact_geometries,
            E::create_scene,
            E::destroy_scene,
            E::scene_temporary_size,
            E::build_scene,
            E::create_function_table,
            E::set_function_table,
            E::destroy_function_table,
            E::build_trace_kernels};
}

std::vector<std::string> FakeHiprt::leaks() const {
    std::vector<std::string> found;
    for (std::size_t i = 0; i < geometries.size(); ++i) found.push_back("a geometry");
    for (std::size_t i = 0; i < scenes.size(); ++i) found.push_back("a scene");
    for (std::size_t i = 0; i < tables.size(); ++i) found.push_back("a function table");
    if (has_context) found.push_back("a context");
    return found;
}

/// Memory for a structure, outside the count of calls: it is a part of the call that asks.
DeviceAddress FakeHiprt::take(std::size_t bytes) {
    const int failing = std::exchange(runtime_.failing_call, -1);
    DeviceAddress address = 0;
    if (runtime_.allocate(bytes, address).kind != GpuResult::Kind::success) address = 0;
    runtime_.calls.pop_back();
    runtime_.failing_call = failing;
    return address;
}

void FakeHiprt::give_back(const void* structure) {
    const int failing = std::exchange(runtime_.failing_call, -1);
    (void)runtime_.release(number_of(structure));
    runtime_.calls.pop_back();
    runtime_.failing_call = failing;
}

void FakeHiprt::check_options(const hiprt::BuildOptions& options) {
    const std::uint32_t quality = options.flags & hiprt::build_flag::kQualityMask;
    if (quality > hiprt::build_flag::kHighQuality) fault("a tree to import is not what we build");
    if ((options.flags & ~(hiprt::build_flag::kQualityMask | hiprt::build_flag::kNoSpatialSplits)) != 0)
        fault("unknown build flags");
    if (options.batch_max_primitives != 0) fault("the batch builder costs a compilation");
}

void FakeHiprt::check_boxes(const hiprt::GeometryBuildInput& input) {
    const hiprt::AabbList& list = input.list;
    if (list.box_count == 0) fault("a list of boxes is empty");
    if (list.box_stride != 24 && list.box_stride != 32) fault("boxes have a wrong stride");
    if (input.geometry_type != kernels::geometry_type::kMoving) fault("boxes have no intersection function");
    runtime_.expect_device({number_of(list.boxes), std::size_t{list.box_count} * list.box_stride}, "boxes");
}

void FakeHiprt::check_mesh(const hiprt::GeometryBuildInput& input, const hiprt::BuildOptions& options) {
    if (input.type == hiprt::PrimitiveType::aabb_list) return check_boxes(input);
    const hiprt::TriangleMesh& mesh = input.mesh;
    if (input.type != hiprt::PrimitiveType::triangle_mesh) fault("a mesh is not of triangles");
    if (mesh.triangle_count == 0 || mesh.vertex_count == 0) fault("a mesh is empty");
    if (mesh.vertex_stride < 12 || mesh.vertex_stride % 4 != 0 || mesh.triangle_stride != 12)
        fault("a mesh has wrong strides");
    if (std::uint64_t{mesh.vertex_count} * mesh.vertex_stride > hiprt::kMostVertexBytes)
        fault("a vertex buffer is 4 GiB or more");
    runtime_.expect_device({number_of(mesh.vertices), std::size_t{mesh.vertex_count} * mesh.vertex_stride}, "vertices");
    runtime_.expect_device({number_of(mesh.indices), std::size_t{mesh.triangle_count} * mesh.triangle_stride},
                           "indices");
    if (input.geometry_type != hiprt::kInvalidValue) {
        if (input.geometry_type != kernels::geometry_type::kFiltered)
            fault("a geometry type that is not one of triangles");
        if ((options.flags & hiprt::build_flag::kNoSpatialSplits) == 0)
            fault("spatial splits let a filter see a triangle more than once");
    }
}

void FakeHiprt::run_box_build(GeometryRecord& record, const hiprt::GeometryBuildInput& input) {
    for (std::uint32_t i = 0; i < input.list.box_count; ++i) {
        float p[6];
        const std::byte* box = static_cast<const std::byte*>(input.list.boxes) + std::size_t{i} * input.list.box_stride;
        std::memcpy(p, box, 12);
        std::memcpy(p + 3, box + input.list.box_stride / 2, 12);
        if (!all_finite(p, 6)) return fault("a box is not finite");
        for (int c = 0; c < 3; ++c)
            if (p[c] > p[c + 3]) return fault("a box is inside out");
    }
    record.built = true;
    record.input = input;
}

void FakeHiprt::run_geometry_build(hiprt::Geometry handle, const hiprt::GeometryBuildInput& input,
                                   hiprt::BuildOperation operation) {
    GeometryRecord& record = geometries.at(handle);
    note_inputs(handle, input);
    if (input.type == hiprt::PrimitiveType::aabb_list) return run_box_build(record, input);
    const hiprt::TriangleMesh& mesh = input.mesh;
    const std::vector<std::uint32_t> indices = read<std::uint32_t>(mesh.indices, std::size_t{3} * mesh.triangle_count);
    for (const std::uint32_t index : indices)
        if (index >= mesh.vertex_count) return fault("an index is beyond the vertices");
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
        float p[3];
        std::memcpy(p, static_cast<const std::byte*>(mesh.vertices) + std::size_t{i} * mesh.vertex_stride, sizeof p);
        if (!all_finite(p, 3)) return fault("a vertex is not finite");
    }
    if (operation == hiprt::BuildOperation::update) {
        if (!record.built) return fault("a geometry is updated before it was built");
        if (indices != record.indices) return fault("a geometry is updated with other triangles");
        ++record.updates;
    }
    record.built = true;
    record.indices = indices;
    record.input = input;
}

void FakeHiprt::run_scene_build(hiprt::Scene handle, const hiprt::SceneBuildInput& input) {
    SceneRecord& scene = scenes.at(handle);
    scene.instances = read<hiprt::Instance>(input.instances, input.instance_count);
    scene.headers = read<kernels::TransformHeader>(input.headers, input.instance_count);
    scene.masks = read<std::uint32_t>(input.masks, input.instance_count);
    if (input.frame_type == hiprt::FrameType::srt)
        scene.srt = read<kernels::FrameSrt>(input.frames, input.frame_count);
    else
        scene.matrices = read<kernels::FrameMatrix>(input.frames, input.frame_count);
    for (std::size_t i = 0; i < scene.instances.size(); ++i)
        std::memcpy(reinterpret_cast<hiprt::Geometry*>(handle) + i, &scene.instances[i].geometry, sizeof(hiprt::Geometry));
    for (const hiprt::Instance& instance : scene.instances) {
        if (instance.type != hiprt::InstanceType::geometry) fault("an instance of something else than a geometry");
        const auto found = geometries.find(instance.geometry);
        if (found == geometries.end() || !found->second.built) fault("an instance of a geometry that was not built");
    }
    for (const kernels::TransformHeader& header : scene.headers) {
        if (header.frame_count == 0 || header.first_frame + header.frame_count > input.frame_count) {
            fault("a transform header beyond the frames");
            continue;
        }
        check_frames(scene, header, input.frame_type);
    }
    scene.built = true;
}

void FakeHiprt::check_frames(const SceneRecord& scene, const kernels::TransformHeader& header, hiprt::FrameType type) {
    const auto pose = [&](unsigned i) {
        return type == hiprt::FrameType::srt ? pose_of(scene.srt[header.first_frame + i])
                                             : pose_of(scene.matrices[header.first_frame + i]);
    };
    Pose before{};
    for (unsigned i = 0; i < header.frame_count; ++i) {
        const Pose now = pose(i);
        if (!now.finite) return fault("a frame is not finite, or its angle is beyond pi");
        if (now.scale.x == 0 || now.scale.y == 0 || now.scale.z == 0) return fault("a frame has a zero scale");
        if (now.time < 0 || now.time > 1) return fault("the time of a frame is outside [0, 1]");
        if (header.frame_count > 1 && glm::length(now.shear) > 1e-4 * glm::length(now.scale))
            return fault("a moving instance is sheared: HIPRT's inverse is wrong");
        if (i > 0) {
            if (!(now.time > before.time)) return fault("times of frames do not increase");
            const double c =
                std::min(1.0, std::abs(glm::dot(glm::normalize(now.rotation), glm::normalize(before.rotation))));
            const double degrees = glm::degrees(2 * std::acos(c));
            if (degrees > most_degrees_a_step)
                return fault(fmt::format("a turn of {:.3f} degrees between two frames", degrees));
            for (int axis = 0; axis < 3; ++axis)
                if (now.scale[axis] * before.scale[axis] < 0) return fault("a scale passes through zero");
        }
        before = now;
    }
    if (header.frame_count > 1 && (pose(0).time != 0 || before.time != 1)) fault("frames do not span the shutter");
}

}  // namespace kadr::test
