#pragma once

// The CPU's driver: one source for one lane and for eight. A batch of paths advances bounce by bounce; rays go to
// Embree in packets, hits are compressed into a small ring so that shading always has full lanes, and shadow rays wait
// in a second ring.
//
// The order of additions to one path's radiance is fixed (light that its ray meets, emission, then the shadow ray,
// bounce by bounce), so a pixel does not depend on its neighbours, on the number of threads or on the order of tiles.

#include <utility>

#include "device/embree/kernel_sets.h"
#include "device/embree/path_columns.h"
#include "device/embree/tile_job.h"
#include "kernels/integrator/camera_path.h"
#include "kernels/integrator/coverage.h"
#include "kernels/integrator/direct.h"
#include "kernels/integrator/path.h"
#include "kernels/integrator/surface_layers.h"

// Compiled once per instruction set: everything lives in a namespace of its own, so that the linker never takes an AVX2
// body for a portable one.
namespace kadr::KADR_DRIVER_NAMESPACE {

using namespace kernels;

/// Lanes below n.
template <class F>
inline Mask<F> first_lanes(int n) {
    Mask<F> m(false);
    for (int i = 0; i < kernels::kLanes<F>; ++i) set_lane(m, i, i < n);
    return m;
}

/// Whether Embree takes a ray from here, in this direction. Where it is built with its assertions, as Debian's is, it ends
/// the program on rays that are not finite, and on coordinates above 1.844e18.
template <class F>
inline Mask<F> is_traceable(Vec3<F> origin, Vec3<F> direction) {
    const F largest(1e18f);
    const auto within = [&](Vec3<F> v) { return (abs(v.x) < largest) & (abs(v.y) < largest) & (abs(v.z) < largest); };
    return within(origin) & within(direction);
}

template <class F, unsigned R, IntegratorKind kIntegrator>
class Driver final : public TileDriver {
    static constexpr int N = kernels::kLanes<F>;

public:
    void render(const TileJob& job, TileResult& result, TileCounters& counters) override {
        job_ = &job;
        result_ = &result;
        counters_ = &counters;
        generate();
        PathColumns* current = &paths_[0];
        PathColumns* next = &paths_[1];
        for (bool camera = true; current->count > 0; camera = false) {
            next->count = 0;
            next_ = next;
            for (int i = 0; i < current->count; i += N) advance(*current, i, camera);
            if (hits_.count > 0) shade(hits_.count);
            hits_.count = 0;
            if (shadows_.count > 0) trace_shadows(shadows_.count);
            shadows_.count = 0;
            std::swap(current, next);
        }
    }

private:
    using PathColumns = Columns<kPathFields, kPathsPerBatch>;

    /// Camera rays of all pixels and samples of the batch.
    void generate() {
        const TileJob& job = *job_;
        const SceneView& scene = *job.scene;
        const int width = job.x1 - job.x0, samples = job.sample_count;
        const int total = width * (job.y1 - job.y0) * samples;
        PathColumns& out = paths_[0];
        out.count = 0;
        for (int first = 0; first < total; first += N) {
            Int<F> x(0), y(0);
            UInt<F> sample(0u), slot(0u);
            for (int i = 0; i < N; ++i) {
                const int s = first + i < total ? first + i : total - 1;
                const int pixel = s / samples;
                set_lane(x, i, job.x0 + pixel % width);
                set_lane(y, i, job.y0 + pixel / width);
                set_lane(sample, i, static_cast<unsigned>(job.first_sample + s % samples));
                set_lane(slot, i, static_cast<unsigned>(s));
            }
            Mask<F> active = first_lanes<F>(total - first);
            if (job.active)
                for (int i = 0; i < N; ++i)
                    if (!job.is_active(lane(x, i), lane(y, i))) set_lane(active, i, false);
            const CameraSample<F> start =
                start_path<F>(scene, *job.filter, *job.shutter, job.seed, job.centred, x, y, sample);
            for (int i = 0; i < N && first + i < total; ++i) {
                const int s = first + i;
                for (int c = 0; c < 3; ++c) result_->radiance[c][s] = 0;
                result_->weight[s] = lane(start.weight, i);
                result_->light[s] = lane(start.light, i);
                result_->alpha[s] = scene.lights.environment_visible ? 1.0f : 0.0f;
                if (job.surface_layers) {
                    for (int c = 0; c < 3; ++c) result_->albedo[c][s] = result_->normal[c][s] = 0;
                    result_->depth[s] = __builtin_inff();
                    result_->motion[0][s] = result_->motion[1][s] = 0;
                }
            }
            append_path<F>(out, start.path, slot, bits(active & (start.light > F(0.0f))));
        }
    }

    void add(UInt<F> slot, Vec3<F> L, unsigned mask) {
        for (; mask; mask &= mask - 1) {
            const int i = __builtin_ctz(mask);
            const unsigned s = lane(slot, i);
            result_->radiance[0][s] += lane(L.x, i);
            result_->radiance[1][s] += lane(L.y, i);
            result_->radiance[2][s] += lane(L.z, i);
        }
    }

    /// Traces one packet, adds what it meets on its way and queues its hits for shading.
    void advance(const PathColumns& in, int at, bool camera) {
        const SceneView& scene = *job_->scene;
        UInt<F> slot;
        PathState<F> path = load_path<F>(in, at, slot);
        Mask<F> active = first_lanes<F>(in.count - at);
        const Mask<F> finite = is_traceable(path.origin, path.direction) & is_finite(path.beta);
        if (any(active & !finite)) drop(slot, bits(active & !finite));
        active = active & finite;
        const unsigned lanes = bits(active);
        if (lanes == 0) return;
        counters_->rays += static_cast<unsigned>(__builtin_popcount(lanes));
        Hit<F> hit;
        trace(path, lanes, camera, hit);
        const Mask<F> found = active & (hit.distance < F(kInfinity));
        if constexpr (kIntegrator == IntegratorKind::path && (R & requirement::kEmitters) != 0) {
            if (scene.lights.visible_count > 0) {
                const Vec3<F> L = visible_lights(scene, path, hit.distance, active);
                const unsigned seen = bits(active & (max_component(L) > F(0.0f)));
                if (seen)
                    add(slot,
                        clamp_contribution(scene.settings, (path.bounces & UInt<F>(0xffu)) < UInt<F>(2u),
                                           L * path.beta),
                        seen);
            }
        }
        const unsigned missed = bits(active & !found);
        if (missed) add(slot, shade_miss<F, R>(scene, path, active & !found), missed);
        const unsigned kept = bits(found);
        if (kept == 0) return;
        const int start = hits_.count;
        append_path<F>(hits_, path, slot, kept);
        store_compressed(hits_.data[kU] + start, hit.u, kept);
        store_compressed(hits_.data[kV] + start, hit.v, kept);
        store_compressed(hits_.data[kDistance] + start, hit.distance, kept);
        store_compressed(hits_.data[kInstance] + start, as_float(UInt<F>(hit.instance)), kept);
        store_compressed(hits_.data[kPrimitive] + start, as_float(UInt<F>(hit.primitive)), kept);
        if (hits_.count >= N) {
            shade(N);
            pop_front(hits_, N);
        }
    }

    template <class C>
    static void pop_front(C& ring, int n) {
        ring.count -= n;
        for (auto& column : ring.data)
            for (int i = 0; i < ring.count; ++i) column[i] = column[n + i];
    }

    void drop(UInt<F> slot, unsigned mask) {
        for (; mask; mask &= mask - 1) result_->radiance[0][lane(slot, __builtin_ctz(mask))] = __builtin_nanf("");
    }

    void log(Vec3<F> origin, Vec3<F> direction, F time, F distance, unsigned lanes, bool shadow, bool flat,
             bool camera) const {
        const unsigned packet = N == 8 && flat ? static_cast<unsigned>(__builtin_popcount(lanes)) : 1;
        for (unsigned todo = lanes, left = packet; todo; todo &= todo - 1, left -= packet > 1 ? 1 : 0) {
            const int i = __builtin_ctz(todo);
            job_->log(job_->log_user, {{lane(origin.x, i), lane(origin.y, i), lane(origin.z, i)},
                                       {lane(direction.x, i), lane(direction.y, i), lane(direction.z, i)},
                                       lane(time, i),
                                       lane(distance, i),
                                       shadow,
                                       flat,
                                       camera,
                                       static_cast<std::uint8_t>(left)});
        }
    }

    /// Closest hits. `distance` is kInfinity where nothing was met.
    void trace(const PathState<F>& path, unsigned lanes, bool camera, Hit<F>& hit) {
        QueryContext context;
        context.keep_blend = kIntegrator == IntegratorKind::direct;
        if constexpr ((R & requirement::kSpecials) != 0)
            for (int i = 0; i < N; ++i)
                context.key[i] = coverage_key(lane(path.sampler_key, i), lane(path.sample, i), lane(path.bounces, i));
        hit.distance = F(kInfinity);
        hit.instance = Int<F>(0);
        hit.primitive = Int<F>(0);
        hit.u = hit.v = F(0.0f);
        if (job_->log && job_->flat)
            log(path.origin, path.direction, path.time, hit.distance, lanes, false, true, camera);
        if constexpr (N == 8) {
            if (job_->flat) trace_packet(path, lanes, context, camera, hit);
        } else {
            if (job_->flat) trace_single(job_->flat, path, lanes, context, camera, hit);
        }
        if constexpr ((R & requirement::kTransforms) != 0) {
            if (job_->log && job_->instanced)
                log(path.origin, path.direction, path.time, hit.distance, lanes, false, false, camera);
            if (job_->instanced) trace_single(job_->instanced, path, lanes, context, camera, hit);
        }
    }

    void trace_packet(const PathState<F>& path, unsigned lanes, QueryContext& context, bool camera, Hit<F>& hit) {
        alignas(32) RTCRayHit8 ray;
        alignas(32) int valid[8];
        fill_packet(ray.ray, path.origin, path.direction, path.time, F(kInfinity));
        for (int i = 0; i < 8; ++i) {
            valid[i] = lanes >> i & 1 ? -1 : 0;
            ray.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
            ray.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect8(valid, job_->flat, context, ray, camera);
        const UInt<F> geometry = load<UInt<F>>(reinterpret_cast<const float*>(ray.hit.geomID));
        const Mask<F> found = geometry != UInt<F>(RTC_INVALID_GEOMETRY_ID);
        hit.instance = select(found, Int<F>(geometry), hit.instance);
        hit.primitive = select(found, load<Int<F>>(reinterpret_cast<const float*>(ray.hit.primID)), hit.primitive);
        hit.u = select(found, load<F>(ray.hit.u), hit.u);
        hit.v = select(found, load<F>(ray.hit.v), hit.v);
        hit.distance = select(found, load<F>(ray.ray.tfar), hit.distance);
    }

    template <class Ray8>
    static void fill_packet(Ray8& ray, Vec3<F> origin, Vec3<F> direction, F time, F distance) {
        store(ray.org_x, origin.x);
        store(ray.org_y, origin.y);
        store(ray.org_z, origin.z);
        store(ray.dir_x, direction.x);
        store(ray.dir_y, direction.y);
        store(ray.dir_z, direction.z);
        store(ray.tnear, F(0.0f));
        store(ray.time, time);
        store(ray.tfar, distance);
        for (int i = 0; i < 8; ++i) {
            ray.mask[i] = 0xffffffffu;
            ray.id[i] = static_cast<unsigned>(i);
            ray.flags[i] = 0;
        }
    }

    static void fill_single(RTCRay& ray, Vec3<F> origin, Vec3<F> direction, F time, float distance, int i) {
        ray.org_x = lane(origin.x, i);
        ray.org_y = lane(origin.y, i);
        ray.org_z = lane(origin.z, i);
        ray.dir_x = lane(direction.x, i);
        ray.dir_y = lane(direction.y, i);
        ray.dir_z = lane(direction.z, i);
        ray.tnear = 0;
        ray.time = lane(time, i);
        ray.tfar = distance;
        ray.mask = 0xffffffffu;
        ray.id = static_cast<unsigned>(i);
        ray.flags = 0;
    }

    static void trace_single(RTCScene target, const PathState<F>& path, unsigned lanes, QueryContext& context,
                             bool camera, Hit<F>& hit) {
        for (; lanes; lanes &= lanes - 1) {
            const int i = __builtin_ctz(lanes);
            RTCRayHit ray;
            fill_single(ray.ray, path.origin, path.direction, path.time, lane(hit.distance, i), i);
            ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            intersect1(target, context, ray, camera);
            if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) continue;
            // Flat geometry and instances are attached under the index of their instance.
            const unsigned instance = ray.hit.instID[0] == RTC_INVALID_GEOMETRY_ID ? ray.hit.geomID : ray.hit.instID[0];
            set_lane(hit.instance, i, static_cast<int>(instance));
            set_lane(hit.primitive, i, static_cast<int>(ray.hit.primID));
            set_lane(hit.u, i, ray.hit.u);
            set_lane(hit.v, i, ray.hit.v);
            set_lane(hit.distance, i, ray.ray.tfar);
        }
    }

    /// Shades the first n entries of the ring.
    void shade(int n) {
        const SceneView& scene = *job_->scene;
        UInt<F> slot;
        const PathState<F> path = load_path<F>(hits_, 0, slot);
        Hit<F> hit;
        hit.u = load<F>(hits_.data[kU]);
        hit.v = load<F>(hits_.data[kV]);
        hit.distance = load<F>(hits_.data[kDistance]);
        hit.instance = load<Int<F>>(hits_.data[kInstance]);
        hit.primitive = load<Int<F>>(hits_.data[kPrimitive]);
        const Mask<F> active = first_lanes<F>(n);
        if constexpr (kIntegrator == IntegratorKind::path) {
            const VertexResult<F> vertex = shade_hit<F, R>(scene, path, hit, active);
            const unsigned emits = bits(active & (max_component(vertex.emitted) > F(0.0f)));
            if (emits) add(slot, vertex.emitted, emits);
            surface(path, hit, vertex.albedo, vertex.normal, slot, active);
            queue_shadow(vertex.shadow, path, slot);
            append_path<F>(*next_, vertex.next, slot, bits(vertex.alive));
        } else {
            const DirectResult<F> vertex = shade_direct<F, R>(
                scene, path, hit, active, [&](Vec3<F> L) { add(slot, L, bits(active)); },
                [&](const ShadowRay<F>& ray) { queue_shadow(ray, path, slot); });
            surface(path, hit, vertex.albedo, vertex.normal, slot, active);
            append_path<F>(*next_, vertex.next, slot, bits(vertex.alive));
        }
    }

    /// Data layers and coverage of the first hit.
    void surface(const PathState<F>& path, const Hit<F>& hit, Vec3<F> albedo, Vec3<F> normal, UInt<F> slot,
                 Mask<F> active) {
        for (unsigned todo = bits(active & (path.bounces == UInt<F>(0u))); todo; todo &= todo - 1) {
            const int i = __builtin_ctz(todo);
            const unsigned s = lane(slot, i);
            result_->alpha[s] = 1;
            if (!job_->surface_layers) continue;
            result_->albedo[0][s] = lane(albedo.x, i);
            result_->albedo[1][s] = lane(albedo.y, i);
            result_->albedo[2][s] = lane(albedo.z, i);
            result_->normal[0][s] = lane(normal.x, i);
            result_->normal[1][s] = lane(normal.y, i);
            result_->normal[2][s] = lane(normal.z, i);
            const Vec3f direction{lane(path.direction.x, i), lane(path.direction.y, i), lane(path.direction.z, i)};
            result_->depth[s] =
                view_depth(job_->scene->camera, lane(path.time, i), direction, lane(hit.distance, i));
            if (job_->scene->previous_matrices) {
                const Vec2f moved = motion_of_point(*job_->scene, static_cast<unsigned>(lane(hit.instance, i)),
                                                    static_cast<unsigned>(lane(hit.primitive, i)), lane(hit.u, i),
                                                    lane(hit.v, i));
                result_->motion[0][s] = moved.x;
                result_->motion[1][s] = moved.y;
            }
        }
    }

    void queue_shadow(const ShadowRay<F>& ray, const PathState<F>& path, UInt<F> slot) {
        const Mask<F> finite = is_traceable(ray.origin, ray.direction) & is_finite(ray.radiance);
        const unsigned dropped = bits(ray.active & !finite);
        if (dropped) drop(slot, dropped);
        const unsigned mask = bits(ray.active & finite);
        if (mask == 0) return;
        const auto f = [&](int field, F x) { store_compressed(shadows_.data[field] + shadows_.count, x, mask); };
        f(kShadowOriginX, ray.origin.x);
        f(kShadowOriginY, ray.origin.y);
        f(kShadowOriginZ, ray.origin.z);
        f(kShadowDirectionX, ray.direction.x);
        f(kShadowDirectionY, ray.direction.y);
        f(kShadowDirectionZ, ray.direction.z);
        f(kShadowDistance, min(ray.distance, F(kInfinity)));
        f(kShadowTime, path.time);
        f(kShadowX, ray.radiance.x);
        f(kShadowY, ray.radiance.y);
        f(kShadowZ, ray.radiance.z);
        f(kShadowKey, as_float(path.sampler_key));
        f(kShadowSlot, as_float(slot));
        shadows_.count += __builtin_popcount(mask);
        if (shadows_.count >= N) {
            trace_shadows(N);
            pop_front(shadows_, N);
        }
    }

    /// Adds what arrives along the first n shadow rays of the ring.
    void trace_shadows(int n) {
        const auto f = [&](int field) { return load<F>(shadows_.data[field]); };
        const Vec3<F> origin{f(kShadowOriginX), f(kShadowOriginY), f(kShadowOriginZ)};
        const Vec3<F> direction{f(kShadowDirectionX), f(kShadowDirectionY), f(kShadowDirectionZ)};
        const F distance = f(kShadowDistance), time = f(kShadowTime);
        unsigned open = (1u << n) - 1u;
        counters_->rays += static_cast<unsigned>(n);
        QueryContext context;
        context.shadow = true;
        for (int i = 0; i < N; ++i) context.transmittance[i] = 1;
        if (job_->log && job_->flat) log(origin, direction, time, distance, open, true, true, false);
        if (job_->flat) {
            if constexpr (N == 8) {
                alignas(32) RTCRay8 ray;
                alignas(32) int valid[8];
                fill_packet(ray, origin, direction, time, distance);
                for (int i = 0; i < 8; ++i) valid[i] = i < n ? -1 : 0;
                occluded8(valid, job_->flat, context, ray);
                open &= bits(load<F>(ray.tfar) >= F(0.0f));
            } else {
                open = shadow_single(job_->flat, origin, direction, time, distance, open, context);
            }
        }
        if constexpr ((R & requirement::kTransforms) != 0) {
            if (job_->log && job_->instanced) log(origin, direction, time, distance, open, true, false, false);
            if (job_->instanced)
                open = shadow_single(job_->instanced, origin, direction, time, distance, open, context);
        }
        if (open == 0) return;
        F transmittance(1.0f);
        if constexpr ((R & requirement::kSpecials) != 0) {
            for (int i = 0; i < N; ++i) set_lane(transmittance, i, context.transmittance[i]);
        }
        add(load<UInt<F>>(shadows_.data[kShadowSlot]), Vec3<F>{f(kShadowX), f(kShadowY), f(kShadowZ)} * transmittance,
            open);
    }

    static unsigned shadow_single(RTCScene target, Vec3<F> origin, Vec3<F> direction, F time, F distance, unsigned open,
                                  QueryContext& context) {
        unsigned left = 0;
        for (; open; open &= open - 1) {
            const int i = __builtin_ctz(open);
            RTCRay ray;
            fill_single(ray, origin, direction, time, lane(distance, i), i);
            occluded1(target, context, ray);
            if (ray.tfar >= 0) left |= 1u << i;
        }
        return left;
    }

    PathColumns paths_[2];
    PathColumns* next_ = nullptr;
    Columns<kHitFields, 16> hits_;
    Columns<kShadowFields, 16> shadows_;
    const TileJob* job_ = nullptr;
    TileResult* result_ = nullptr;
    TileCounters* counters_ = nullptr;
};

/// @tparam kSets  a list of kernel_sets
/// @param set     one of them. @return null for another
template <class F, IntegratorKind kIntegrator, const auto& kSets, std::size_t... I>
TileDriver* make_one_of(unsigned set, std::index_sequence<I...>) {
    TileDriver* driver = nullptr;
    ((set == kSets[I] ? void(driver = new Driver<F, kSets[I], kIntegrator>()) : void()), ...);
    return driver;
}

template <class F, IntegratorKind kIntegrator, const auto& kSets>
TileDriver* make_one_of(unsigned set) {
    return make_one_of<F, kIntegrator, kSets>(set, std::make_index_sequence<kSets.size()>());
}

}  // namespace kadr::KADR_DRIVER_NAMESPACE
