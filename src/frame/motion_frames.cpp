#include "frame/motion_frames.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "frame/bindings.h"
#include "frame/instance_fit.h"
#include "frame/placed_instances.h"

namespace kadr {

namespace {

constexpr std::size_t kBatch = 2048;  // instances evaluated together; their samples stay in the cache

/// Flattening a mesh gives it a structure of its own for every copy; beyond some thousands that costs more than it saves.
constexpr std::size_t kMostFlattenedCopies = 4096;

struct Batch {
    std::vector<Instance> instances;
    InstanceFits fits;
};

/// The ranges cut into pieces of kBatch instances, and short ones put together.
std::vector<std::vector<IdRange>> pieces_of(std::span<const IdRange> ranges) {
    std::vector<std::vector<IdRange>> pieces;
    std::size_t free = 0;
    for (IdRange rest : ranges)
        while (rest.count > 0) {
            if (free == 0) pieces.emplace_back(), free = kBatch;
            const std::size_t count = std::min(free, rest.count);
            pieces.back().push_back({rest.first, count});
            free -= count;
            rest = {rest.first + count, rest.count - count};
        }
    return pieces;
}

std::vector<Batch> fit_batches(const Interval& interval, std::span<const IdRange> ranges) {
    const std::vector<std::vector<IdRange>> pieces = pieces_of(ranges);
    std::vector<Batch> batches(pieces.size());
    tbb::parallel_for(std::size_t{0}, batches.size(), [&](std::size_t b) {
        for (const IdRange& range : pieces[b]) {
            const std::vector<Instance> members = interval.shot.bindings().instances.range(range.first, range.count);
            batches[b].instances.insert(batches[b].instances.end(), members.begin(), members.end());
        }
        batches[b].fits = fit_instances(interval, batches[b].instances);
    });
    std::vector<Diagnostic> problems;
    for (const Batch& batch : batches) problems.insert(problems.end(), batch.fits.problems.begin(), batch.fits.problems.end());
    if (!problems.empty()) throw InputError(std::move(problems));
    return batches;
}

MotionFit quality_of(const std::vector<Batch>& batches) {
    MotionFit all;
    for (const Batch& batch : batches) {
        const MotionFit& fit = batch.fits.quality;
        all.too_fast |= fit.too_fast;
        all.missed |= fit.missed;
        all.widest_step_rad = std::max(all.widest_step_rad, fit.widest_step_rad);
        all.corners_s.insert(all.corners_s.end(), fit.corners_s.begin(), fit.corners_s.end());
    }
    return all;
}

float frame_time(std::size_t frame, std::size_t count) {
    return count > 1 ? static_cast<float>(static_cast<double>(frame) / static_cast<double>(count - 1)) : 0.0f;
}

/// Lays the frames of batches out in lists that follow others of some lengths.
class Packing {
public:
    Packing(const Interval& interval, const std::vector<Batch>& batches, const PlacedInstances* before) : shot_(interval.shot), unit_m_(interval.space.unit_m) {
        if (before) srt_before_ = before->srt.size(), matrices_before_ = before->matrices.size(), places_before_ = before->fixed_places.size();
        std::size_t most = 0;
        for (const Batch& batch : batches) most += batch.instances.size();
        reserve(most);
        for (const Batch& batch : batches)
            for (std::size_t i = 0; i < batch.instances.size(); ++i)
                if (!batch.fits.fitted[i].hidden) add(batch.instances[i], batch.fits.fitted[i], batch.fits.frames);
        placed_.srt.resize(srt_count_);
        placed_.matrices.resize(matrix_count_);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, sources_.size(), 1024), [&](const auto& range) {
            for (std::size_t i = range.begin(); i < range.end(); ++i) write_frames(i);
        });
    }

    PlacedInstances take() { return std::move(placed_); }
    double max_error_px() const { return max_error_px_; }
    double bending_error_px() const { return bending_error_px_; }
    std::size_t worst() const { return worst_; }  ///< index into the lists

private:
    void reserve(std::size_t count) {
        sources_.reserve(count);
        placed_.instances.reserve(count);
        placed_.headers.reserve(count);
        placed_.types.reserve(count);
        placed_.linear.reserve(count);
    }

    void add(const Instance& source, const InstanceFits::Fitted& fitted, const std::vector<Decomposition>& frames) {
        const auto parts = std::span(frames).subspan(fitted.first, fitted.count);
        const bool sheared = std::any_of(parts.begin(), parts.end(), is_sheared);
        std::size_t& count = sheared ? matrix_count_ : srt_count_;
        sources_.push_back(parts.data());
        placed_.headers.push_back({static_cast<unsigned>((sheared ? matrices_before_ : srt_before_) + count), fitted.count});
        placed_.types.push_back(sheared ? FrameType::matrix : FrameType::srt);
        placed_.linear.push_back(fitted.linear ? 1 : 0);
        count += fitted.count;
        for (const Decomposition& part : parts) placed_.reach.add(source.id, part);
        add_instance(source);
        if (source.seed->deformer >= 0) bending_error_px_ = std::max<double>(bending_error_px_, fitted.error_px);
        if (fitted.error_px > max_error_px_) max_error_px_ = fitted.error_px, worst_ = placed_.instances.size() - 1;
    }

    void add_instance(const Instance& source) {
        const Bindings& bindings = shot_.bindings();
        const int node = source.seed->node;
        SnapshotInstance instance{source.seed->geometry, bindings.materials.material_in_copy(source.seed->material, source.clip_offset_s()), source.id};
        const std::size_t copies = bindings.instances.copies_of(bindings.rig.file_of(node)).size();
        if (!bindings.rig.moves(node) && copies <= kMostFlattenedCopies) {
            instance.fixed_place = static_cast<std::int32_t>(places_before_ + placed_.fixed_places.size());
            placed_.fixed_places.push_back(bindings.node_transform(node, source.copy, 0) * bindings.copied_from_geometry(shot_.scene(), source));
        }
        placed_.instances.push_back(instance);
    }

    void write_frames(std::size_t i) {
        const auto [first, count] = placed_.headers[i];
        for (std::size_t k = 0; k < count; ++k) {
            const float time = frame_time(k, count);
            if (placed_.types[i] == FrameType::matrix) {
                placed_.matrices[first - matrices_before_ + k] = to_matrix(in_units(sources_[i][k]), time);
                continue;
            }
            const std::size_t at = first - srt_before_ + k;
            placed_.srt[at] = to_srt(in_units(sources_[i][k]), time, k > 0 ? &placed_.srt[at - 1] : nullptr);
        }
    }

    Decomposition in_units(Decomposition parts) const {
        parts.translation /= unit_m_;
        parts.scale /= unit_m_;
        parts.shear /= unit_m_;
        return parts;
    }

    const BoundShot& shot_;
    const double unit_m_;
    PlacedInstances placed_;
    std::vector<const Decomposition*> sources_;  ///< [instance] its frames
    std::size_t srt_before_ = 0, matrices_before_ = 0, places_before_ = 0;
    std::size_t srt_count_ = 0, matrix_count_ = 0;
    double max_error_px_ = 0, bending_error_px_ = 0;
    std::size_t worst_ = 0;
};

/// What stands still, seen from the interval's render origin.
std::shared_ptr<const PlacedInstances> still_places(const Interval& interval) {
    const Bindings& bindings = interval.shot.bindings();
    if (auto known = bindings.still_places->find(interval.space)) return known;
    const std::vector<Batch> batches = fit_batches(interval, bindings.still);
    auto placed = std::make_shared<PlacedInstances>(Packing(interval, batches, nullptr).take());
    placed->key = key_of(*placed);
    return bindings.still_places->keep(interval.space, std::move(placed));
}

/// A list that begins with one of `still`, which it keeps alive, and goes on with `own`.
template <class T>
SharedList<T> joined(const std::shared_ptr<const PlacedInstances>& still, std::vector<T> PlacedInstances::*list, PlacedInstances& own) {
    return {std::shared_ptr<const std::vector<T>>(still, &((*still).*list)), std::move(own.*list)};
}

void join(const std::shared_ptr<const PlacedInstances>& still, PlacedInstances own, SceneSnapshot& snapshot) {
    MotionFrames& motion = snapshot.motion;
    snapshot.instances = joined(still, &PlacedInstances::instances, own);
    snapshot.fixed_places = joined(still, &PlacedInstances::fixed_places, own);
    motion.headers = joined(still, &PlacedInstances::headers, own);
    motion.types = joined(still, &PlacedInstances::types, own);
    motion.linear = joined(still, &PlacedInstances::linear, own);
    motion.srt = joined(still, &PlacedInstances::srt, own);
    motion.matrices = joined(still, &PlacedInstances::matrices, own);
    snapshot.still_key = still->key;
}

}  // namespace

kernels::FrameSrt to_srt(const Decomposition& parts, float time, const kernels::FrameSrt* previous) {
    const glm::dquat q = parts.rotation.w < 0 ? -parts.rotation : parts.rotation;
    const glm::dvec3 v(q.x, q.y, q.z);
    const double sine = glm::length(v);
    const glm::dvec3 before = previous ? glm::dvec3(previous->axis[0], previous->axis[1], previous->axis[2]) : glm::dvec3(0, 0, 1);
    glm::dvec3 axis = sine > 1e-12 ? v / sine : before;
    double angle = 2 * std::atan2(sine, q.w);
    if (previous && glm::dot(axis, before) < 0) axis = -axis, angle = -angle;
    kernels::FrameSrt frame{};
    // The float nearest to pi lies above pi.
    constexpr float kPi = 3.14159250f;
    frame.angle = std::clamp(static_cast<float>(angle), -kPi, kPi);
    for (int i = 0; i < 3; ++i) {
        frame.axis[i] = static_cast<float>(axis[i]);
        frame.scale[i] = static_cast<float>(parts.scale[i]);
        frame.translation[i] = static_cast<float>(parts.translation[i]);
    }
    frame.time = time;
    return frame;
}

kernels::FrameMatrix to_matrix(const Decomposition& parts, float time) {
    const glm::dmat4 m = compose(parts);
    kernels::FrameMatrix frame{};
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) frame.matrix[row][column] = static_cast<float>(m[column][row]);
    frame.time = time;
    return frame;
}

Decomposition frame_parts(const MotionFrames& motion, std::size_t instance, std::size_t frame) {
    const std::size_t index = motion.headers[instance].first_frame + frame;
    if (motion.types[instance] == FrameType::matrix) {
        glm::dmat4 m(1);
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 4; ++column) m[column][row] = motion.matrices[index].matrix[row][column];
        return decompose(m);
    }
    const kernels::FrameSrt& srt = motion.srt[index];
    const glm::dvec3 axis(srt.axis[0], srt.axis[1], srt.axis[2]);
    return {glm::angleAxis(static_cast<double>(srt.angle), glm::normalize(axis)), glm::dvec3(srt.scale[0], srt.scale[1], srt.scale[2]),
            glm::dvec3(0), glm::dvec3(srt.translation[0], srt.translation[1], srt.translation[2])};
}

glm::dmat4 interpolate(const MotionFrames& motion, std::size_t instance, double time) {
    const unsigned count = motion.headers[instance].frame_count;
    if (count == 1) return compose(frame_parts(motion, instance, 0));
    const double position = std::clamp(time, 0.0, 1.0) * (count - 1);
    const auto segment = std::min(static_cast<unsigned>(position), count - 2);
    const Decomposition from = frame_parts(motion, instance, segment), to = frame_parts(motion, instance, segment + 1);
    const double u = position - segment;
    if (motion.mixes_matrices && motion.linear[instance]) return compose(from) * (1 - u) + compose(to) * u;
    return compose(interpolate(from, to, u));
}

MotionFit add_motion_frames(const BoundShot& shot, double open_s, double close_s, SceneSnapshot& snapshot) {
    const Interval interval{shot, snapshot.space(), open_s, close_s, shot.shot().render.motion_tolerance_px, shot.shot().image.height};
    const std::vector<Batch> batches = fit_batches(interval, shot.bindings().changing);
    MotionFit fit = quality_of(batches);
    if (fit.too_fast) return fit;
    const std::shared_ptr<const PlacedInstances> still = still_places(interval);
    Packing packing(interval, batches, still.get());
    PlacedInstances own = packing.take();
    fit.reach = still->reach;
    fit.reach.add(own.reach);
    join(still, std::move(own), snapshot);
    snapshot.motion.mixes_matrices = interval.fixed() && interval.fixed()->mix == MotionMix::matrix;
    snapshot.motion.widest_step_rad = fit.widest_step_rad;
    snapshot.motion.max_error_px = packing.max_error_px();
    snapshot.motion.bending_error_px = packing.bending_error_px();
    snapshot.motion.worst = static_cast<std::uint32_t>(packing.max_error_px() > 0 ? still->instances.size() + packing.worst() : 0);
    return fit;
}

}  // namespace kadr
