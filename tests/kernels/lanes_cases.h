// Every kernel function on one set of inputs, for one width. Built twice: for float, and for eight lanes.
#pragma once

#include "kernels/bsdf/analytic.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/camera/camera.h"
#include "kernels/camera/filter.h"
#include "kernels/camera/shutter.h"
#include "kernels/light/environment.h"
#include "kernels/light/light.h"
#include "kernels/sampler/sobol.h"
#include "kernels/texture/texture.h"

namespace kadr::kernels {

inline constexpr int kCaseInputs = 16;
inline constexpr int kCaseOutputs = 48;

/// What the cases look at; owned by the test.
struct CaseWorld {
    const Camera* cameras;
    int camera_count;
    const FilterTable* filters;
    int filter_count;
    const Light* const* lights;  ///< [light_count] keys of each
    const int* light_keys;
    int light_count;
    const EnvironmentMap* environment;
    const Texture* textures;
    int texture_count;
    const Shutter* shutters;
    int shutter_count;
};

/// Collects results; what is not written stays 0.
template <class F>
struct Outputs {
    F* values;
    int count = 0;
    void add(F x) { values[count++] = x; }
    void add(Vec2<F> v) { add(v.x), add(v.y); }
    void add(Vec3<F> v) { add(v.x), add(v.y), add(v.z); }
    void add_mask(Mask<F> m) { add(select(m, F(1.0f), F(0.0f))); }
};

template <class F>
Vec3<F> case_direction(F u, F v) {
    return sample_cone(F(2.0f), Vec2<F>{u, v});
}

template <class F>
void case_sampler(const CaseWorld&, const F* in, Outputs<F>& out) {
    const auto integer = [](F u) { return truncate(u * F(5000.0f)); };
    const Sampler<F> s = make_sampler<F>(integer(in[0]), integer(in[1]), UInt<F>(integer(in[2])), 17u);
    out.add(s.get_2d(UInt<F>(integer(in[3]))));
    out.add(s.get_1d(UInt<F>(integer(in[4]))));
}

template <class F>
void case_filter(const CaseWorld& world, const F* in, Outputs<F>& out) {
    for (int i = 0; i < world.filter_count; ++i) {
        Vec2<F> offset;
        F weight;
        sample_filter(world.filters[i], Vec2<F>{in[0], in[1]}, offset, weight);
        out.add(offset), out.add(weight);
    }
}

template <class F>
void case_shutter(const CaseWorld& world, const F* in, Outputs<F>& out) {
    for (int i = 0; i < world.shutter_count; ++i) {
        const F line = line_of_pixel<F>(world.shutters[i].direction, truncate(in[0] * F(64.0f)), truncate(in[1] * F(48.0f)), 64, 48);
        F time, weight;
        sample_shutter(world.shutters[i], line, in[2], time, weight);
        out.add(time), out.add(weight);
    }
}

template <class F>
void case_camera(const CaseWorld& world, const F* in, Outputs<F>& out) {
    for (int i = 0; i < world.camera_count; ++i) {
        Vec3<F> origin, direction;
        camera_ray(world.cameras[i], 64, 48, Vec2<F>{in[0] * F(64.0f), in[1] * F(48.0f)}, in[2], Vec2<F>{in[3], in[4]},
                   origin, direction);
        out.add(origin), out.add(direction);
        out.add(project(world.cameras[i], 64, 48, origin + direction * F(3.0f), in[5]));
    }
}

template <unsigned R, class F>
void add_bsdf(const F* in, F roughness, Outputs<F>& out) {
    const F cos_o = max(in[0], F(1e-4f));
    const Bsdf<F> b = make_bsdf<R>(Vec3<F>{in[1], in[2], in[3]}, in[4], roughness, cos_o, in[11], true);
    out.add(b.f0), out.add(b.diffuse), out.add(b.specular_scale), out.add(b.alpha), out.add(b.specular_probability);
    const Vec3<F> wo{safe_sqrt(F(1.0f) - cos_o * cos_o), F(0.0f), cos_o};
    const BsdfValue<F> value = evaluate_bsdf<R>(b, wo, case_direction(in[6], in[7]));
    out.add(value.f_cos), out.add(value.pdf);
    const BsdfSample<F> sample = sample_bsdf<R>(b, wo, Vec2<F>{in[8], in[9]}, in[10]);
    out.add(sample.wi), out.add(sample.pdf), out.add_mask(sample.glossy), out.add(luminance(sample.weight));
}

/// Of any width; and of a width around the cut, a delta in some lanes; both Fresnel terms.
template <class F>
void case_bsdf(const CaseWorld&, const F* in, Outputs<F>& out) {
    add_bsdf<0>(in, in[5], out);
    add_bsdf<requirement::kMirrors | requirement::kFresnel>(in, in[5] * F(0.01f), out);
}

template <class F>
void case_analytic(const CaseWorld&, const F* in, Outputs<F>& out) {
    const Vec3<F> color{in[0], in[1], in[2]}, n = case_direction(in[5], in[6]), wo = case_direction(in[7], in[8]), wi = case_direction(in[9], in[10]);
    out.add(analytic_brdf(color, in[3], in[4], in[11], n, wo, wi));
    out.add(analytic_brdf<requirement::kFresnel>(color, in[3], in[4], in[11], n, wo, wi, true));
}

template <class F>
void case_light(const CaseWorld& world, int light, const F* in, Outputs<F>& out) {
    const Light* keys = world.lights[light];
    const int count = world.light_keys[light];
    const Vec3<F> p{in[0] * F(6.0f) - F(3.0f), in[1] * F(6.0f) - F(3.0f), in[2] * F(6.0f) - F(3.0f)};
    const LightSample<F> s = sample_light(keys, count, in[3], p, Vec2<F>{in[4], in[5]});
    out.add(s.direction), out.add(s.distance), out.add(s.radiance), out.add(s.pdf);
    const LightHit<F> h = intersect_light(keys, count, in[3], p, s.direction);
    out.add(h.distance), out.add(h.radiance), out.add(h.pdf);
    out.add(light_weight(keys, count, in[3], p, case_direction(in[6], in[7])));
}

template <class F>
void case_environment(const CaseWorld& world, const F* in, Outputs<F>& out) {
    Vec3<F> direction, radiance;
    F pdf;
    sample_environment(*world.environment, Vec2<F>{in[0], in[1]}, direction, radiance, pdf);
    out.add(direction), out.add(radiance), out.add(pdf);
    const Vec3<F> other = case_direction(in[2], in[3]);
    out.add(environment_radiance(*world.environment, other)), out.add(environment_pdf(*world.environment, other));
}

template <class F>
void case_texture(const CaseWorld& world, const F* in, Outputs<F>& out) {
    const Int<F> texture = truncate(in[0] * F(static_cast<float>(world.texture_count + 1))) - Int<F>(1);
    const TextureSlot slot{0, 1, 0.5f, 0.25f, 0.1f, -0.25f, 0.5f, 0.2f};
    const Vec2<F> uv =
        apply_transform(slot, Vec2<F>{in[1], in[2]}, Vec2<F>{in[3] * F(9.0f) - F(4.0f), in[4] * F(9.0f) - F(4.0f)});
    const Vec4<F> t = sample_texture<F>(world.textures, texture, uv, in[5] < F(0.9f));
    out.add(uv), out.add(t.x), out.add(t.y), out.add(t.z), out.add(t.w);
}

/// All cases for kLanes<F> consecutive lanes of inputs [kCaseInputs][8]; outputs [kCaseOutputs][8] of case `index`.
template <class F>
void run_case(const CaseWorld& world, int index, const float* inputs, float* outputs) {
    for (int first = 0; first < 8; first += kLanes<F>) {
        F in[kCaseInputs], results[kCaseOutputs];
        for (int i = 0; i < kCaseInputs; ++i) in[i] = Memory<F>::load(inputs + 8 * i + first);
        for (F& r : results) r = F(0.0f);
        Outputs<F> out{results};
        using Case = void (*)(const CaseWorld&, const F*, Outputs<F>&);
        constexpr Case kCases[] = {case_sampler<F>,  case_filter<F>,      case_camera<F>,  case_bsdf<F>,
                                   case_analytic<F>, case_environment<F>, case_texture<F>, case_shutter<F>};
        if (index < 8)
            kCases[index](world, in, out);
        else
            case_light(world, index - 8, in, out);
        for (int i = 0; i < kCaseOutputs; ++i) Memory<F>::store(outputs + 8 * i + first, results[i]);
    }
}

/// run_case for eight lanes; needs AVX2.
void run_case_avx2(const CaseWorld& world, int index, const float* inputs, float* outputs);

}  // namespace kadr::kernels
