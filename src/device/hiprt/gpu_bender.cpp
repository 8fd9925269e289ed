#include "device/hiprt/gpu_bender.h"

#include <algorithm>

#include "frame/skinning.h"

namespace kadr {

MorphTable make_morph_table(const GeometryData& geometry) {
    MorphTable table;
    if (geometry.targets.empty()) return table;
    using namespace kernels::morph_part;
    table.first.assign(geometry.positions.size() + 1, 0);
    for (const MorphTarget& target : geometry.targets) {
        table.parts.push_back(static_cast<unsigned char>((target.positions.empty() ? 0 : kPosition) | (target.normals.empty() ? 0 : kNormal) |
                                                         (target.tangents.empty() ? 0 : kTangent)));
        for (const std::uint32_t v : target.vertices) ++table.first[v + 1];
    }
    for (std::size_t v = 0; v < geometry.positions.size(); ++v) table.first[v + 1] += table.first[v];
    table.entries.resize(table.first.back());
    std::vector<unsigned> next(table.first.begin(), table.first.end() - 1);
    const auto at = [](const std::vector<kernels::Vec3f>& list, std::size_t i) { return list.empty() ? kernels::Vec3f{0, 0, 0} : list[i]; };
    for (std::size_t t = 0; t < geometry.targets.size(); ++t) {
        const MorphTarget& target = geometry.targets[t];
        for (std::size_t i = 0; i < target.vertices.size(); ++i)
            table.entries[next[target.vertices[i]]++] = {static_cast<unsigned>(t), at(target.positions, i), at(target.normals, i), at(target.tangents, i)};
    }
    return table;
}

PoseTable make_pose_table(const DeformedMesh& mesh, const GeometryData& geometry) {
    PoseTable table;
    const std::vector<VertexPose>& poses = *mesh.poses;
    table.joint_count = static_cast<unsigned>(poses.front().matrices().size());
    table.target_count = static_cast<unsigned>(geometry.targets.size());
    for (const VertexPose& pose : poses) {
        table.matrices.insert(table.matrices.end(), pose.matrices().begin(), pose.matrices().end());
        table.dual_quaternions.insert(table.dual_quaternions.end(), pose.dual_quaternions().begin(), pose.dual_quaternions().end());
        // Targets without a weight stay out.
        const std::size_t given = std::min<std::size_t>(pose.weights().size(), table.target_count);
        table.weights.insert(table.weights.end(), pose.weights().begin(), pose.weights().begin() + static_cast<std::ptrdiff_t>(given));
        table.weights.insert(table.weights.end(), table.target_count - given, 0.0f);
        table.stretches.push_back(pose.stretches() ? 1 : 0);
    }
    return table;
}

template <class T>
DeviceBuffer<T> GpuBender::copy(const std::vector<T>& values) {
    DeviceBuffer<T> buffer(memory_, values.size(), MemoryUse::vertices);
    uploads_.add(buffer, values);
    return buffer;
}

const GpuBender::Rest& GpuBender::rest_of(unsigned geometry) {
    if (const auto known = rest_.find(geometry); known != rest_.end()) return known->second;
    const GeometryData& source = scene_.geometries[geometry];
    const MorphTable morphs = make_morph_table(source);
    Rest rest;
    rest.positions = copy(source.positions);
    rest.normals = copy(source.normals);
    rest.tangents = copy(source.tangents);
    rest.uv = copy(source.uv[0]);
    rest.joints = copy(source.skin.joints);
    rest.joint_weights = copy(source.skin.weights);
    rest.morph_first = copy(morphs.first);
    rest.morphs = copy(morphs.entries);
    rest.morph_parts = copy(morphs.parts);
    rest.view = {rest.positions.data(),   rest.normals.data(),     rest.tangents.data(), rest.uv.data(),
                 rest.joints.data(),      rest.joint_weights.data(), rest.morph_first.data(), rest.morphs.data(),
                 rest.morph_parts.data(), static_cast<unsigned>(source.positions.size()), source.skin.per_vertex};
    return rest_.emplace(geometry, std::move(rest)).first->second;
}

void GpuBender::launch(kernels::Kernel kernel, std::size_t threads, void* argument) {
    const LaunchSize size{static_cast<unsigned>((threads + kernels::kBendBlock - 1) / kernels::kBendBlock), 1, kernels::kBendBlock, 1};
    void* const arguments[] = {argument};
    check(memory_.runtime().launch(kernel_(kernel), size, arguments, stream_.handle()), "start a kernel on the GPU");
}

void GpuBender::bend(const DeformedMesh& mesh, const kernels::Geometry& host, const GpuMesh& data) {
    const Rest& rest = rest_of(mesh.geometry);
    const PoseTable poses = make_pose_table(mesh, scene_.geometries[mesh.geometry]);
    matrices_.set(memory_, uploads_, poses.matrices);
    dual_quaternions_.set(memory_, uploads_, poses.dual_quaternions);
    weights_.set(memory_, uploads_, poses.weights);
    stretches_.set(memory_, uploads_, poses.stretches);
    kernels::BendParams params{};
    params.rest = rest.view;
    params.poses = {matrices_.data(), poses.dual_quaternions.empty() ? nullptr : dual_quaternions_.data(), weights_.data(), stretches_.data(),
                    poses.joint_count, poses.target_count, mesh.key_count};
    params.vertices = static_cast<kernels::Vertex*>(data.vertices.pointer());
    params.tangents = static_cast<kernels::Vec4f*>(data.tangents.pointer());
    launch(kernels::Kernel::bend, data.vertices.count(), &params);
    if (data.boxes.count() == 0) return;
    kernels::BoxParams boxes{data.view(host), static_cast<kernels::TriangleBox*>(data.boxes.pointer())};
    launch(kernels::Kernel::boxes, data.boxes.count(), &boxes);
}

}  // namespace kadr
