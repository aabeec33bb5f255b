// SPDX-License-Identifier: Apache-2.0
// The steps of a path in SIMD lanes: formulas, names and order of operations as in shading/surface_point.cpp,
// ggx.hpp, sampling.hpp, metallic_roughness.cpp and radiance/path.cpp, so that the bits are the same.
#include "radiance/path_lanes.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "radiance/path_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

struct Frames {
    V3 s, t, n;
};
HWY_INLINE V3 to_local(const Frames& f, V3 w) { return {dot(w, f.s), dot(w, f.t), dot(w, f.n)}; }
HWY_INLINE V3 to_world(const Frames& f, V3 w) { return f.s * w.x + f.t * w.y + f.n * w.z; }

HWY_INLINE Frames frame_around(V3 n) {
    const VF sign = hn::CopySign(constant(1), n.z);
    const VF a = constant(-1) / (sign + n.z);
    const VF b = n.x * n.y * a;
    return {{constant(1) + sign * n.x * n.x * a, sign * b, hn::Neg(sign) * n.x},
            {b, sign + n.y * n.y * a, hn::Neg(n.y)},
            n};
}

/// frame_along where that has a direction, else `other`.
HWY_INLINE Frames frame_along(V3 n, V3 direction, const Frames& other) {
    const V3 s = direction - n * dot(n, direction);
    const VF length2 = dot(s, s);
    const Mask known = hn::Gt(length2, constant(1e-12f) * dot(direction, direction));
    const V3 unit_s = s / hn::Sqrt(length2);
    return {select(known, unit_s, other.s), select(known, cross(n, unit_s), other.t), n};
}

HWY_INLINE V3 keep_viewer_above(V3 n, V3 w_out) {
    const VF least = constant(min_view_cosine), cosine = dot(n, w_out);
    const Mask above = hn::Ge(cosine, least);
    return hn::AllTrue(F(), above) ? n : select(above, n, normalize(n + w_out * (least - cosine)));
}

/// One vector of vertices.
struct Vertices {
    V3 position, geometric_normal, w_out;
    Frames frame;
    VF offset;

    HWY_INLINE Vertices(const VertexLanes& v, std::size_t i)
        : position(load(v.position, i)),
          geometric_normal(load(v.geometric_normal, i)),
          w_out(load(v.w_out, i)),
          frame{load(v.s, i), load(v.t, i), load(v.n, i)},
          offset(load(v.offset, i)) {}
};

HWY_INLINE V3 ray_origin(const Vertices& v, V3 direction) {
    const Mask below = hn::Lt(dot(direction, v.geometric_normal), zero());
    return v.position + v.geometric_normal * select(below, hn::Neg(v.offset), v.offset);
}

HWY_INLINE Mask sides_agree(const Vertices& v, V3 w_in) {
    const Mask geometric = hn::Gt(dot(w_in, v.geometric_normal), zero());
    return hn::Not(hn::Xor(geometric, hn::Gt(dot(w_in, v.frame.n), zero())));
}

/// One vector of BSDFs. Where no lobe is `Stretched` there is nothing to multiply.
template <bool Stretched>
struct Layers {
    V3 diffuse, coat_f0, coat_f90, specular_f0, specular_f90;
    VF alpha, stretch_x, stretch_y;
    Mask separable;

    HWY_INLINE Layers(const LayerLanes& b, std::size_t i)
        : diffuse(load(b.diffuse, i)),
          coat_f0(load(b.coat_f0, i)),
          coat_f90(load(b.coat_f90, i)),
          specular_f0(load(b.specular_f0, i)),
          specular_f90(load(b.specular_f90, i)),
          alpha(load(b.alpha, i)),
          stretch_x(Stretched ? load(b.stretch_x, i) : constant(1)),
          stretch_y(Stretched ? load(b.stretch_y, i) : constant(1)),
          separable(load(b.separable, i)) {}

    [[nodiscard]] HWY_INLINE VF along_x(VF x) const {
        if constexpr (Stretched) return stretch_x * x;
        return x;
    }
    [[nodiscard]] HWY_INLINE VF along_y(VF y) const {
        if constexpr (Stretched) return stretch_y * y;
        return y;
    }
    /// stretched2
    [[nodiscard]] HWY_INLINE VF stretched2(V3 w) const {
        return squared(along_x(w.x)) + squared(along_y(w.y));
    }
    [[nodiscard]] HWY_INLINE V3 roughened(V3 v) const {
        if constexpr (Stretched) return {alpha * stretch_x * v.x, alpha * stretch_y * v.y, v.z};
        return {alpha * v.x, alpha * v.y, v.z};
    }
    [[nodiscard]] HWY_INLINE VF least_alpha() const {
        if constexpr (Stretched) return alpha * hn::Min(stretch_x, stretch_y);
        return alpha;
    }
};

HWY_INLINE V3 schlick(V3 f0, V3 f90, VF cosine) {
    const VF x = hn::Min(hn::Max(constant(1) - cosine, zero()), constant(1));
    return f0 + (f90 - f0) * (squared(squared(x)) * x);
}

HWY_INLINE VF grazing_albedo(VF cosine, VF alpha) {
    const VF x = hn::Min(hn::Max(constant(1) - cosine, constant(1e-3f)), constant(1)), x2 = squared(x);
    const VF flat = hn::Max(constant(1) - constant(6) * alpha, zero());
    const VF steep = constant(20) * squared(alpha) / (alpha + constant(0.02f));
    return hn::Min(squared(x2) * x / (flat + steep * x2), constant(1));
}

template <bool Stretched>
HWY_INLINE VF grazing_albedo(const Layers<Stretched>& b, VF cosine) {
    const VF mean = grazing_albedo(cosine, b.alpha);
    if constexpr (!Stretched) return mean;
    const VF rough = b.alpha * hn::Max(b.stretch_x, b.stretch_y);
    const VF sharp = hn::Max(constant(0.8f) * b.least_alpha(), constant(0.06f) * rough);
    const VF most = hn::Max(hn::Max(mean, grazing_albedo(cosine, sharp)), grazing_albedo(cosine, rough));
    return select(hn::Eq(b.stretch_x, constant(1)), mean, most);
}

template <bool Stretched>
HWY_INLINE VF coat_transmittance(const Layers<Stretched>& b, VF cosine) {
    const V3 reflected = b.coat_f0 + (b.coat_f90 - b.coat_f0) * grazing_albedo(b, cosine);
    return constant(1) - hn::Min(constant(1), max_component(reflected));
}

template <bool Stretched>
HWY_INLINE VF specular_probability(const Layers<Stretched>& b, V3 w_out) {
    const VF specular = max_component(schlick(b.specular_f0, b.specular_f90, w_out.z));
    const VF diffuse = max_component(b.diffuse) * coat_transmittance(b, w_out.z);
    const VF share = hn::Min(hn::Max(specular / (specular + diffuse), constant(0.1f)), constant(0.9f));
    return select(hn::Le(specular, zero()), zero(), select(hn::Le(diffuse, zero()), constant(1), share));
}

template <bool Stretched>
HWY_INLINE VF ggx_density(const Layers<Stretched>& b, V3 m) {
    const VF a2 = squared(b.alpha);
    V3 squeezed = m;
    if constexpr (Stretched) squeezed = {b.stretch_y * m.x, b.stretch_x * m.y, m.z};
    return a2 * constant(inv_pi) / squared(a2 * squared(m.z) + squared(squeezed.x) + squared(squeezed.y));
}

template <bool Stretched>
HWY_INLINE VF ggx_lambda(const Layers<Stretched>& b, V3 w) {
    const VF tan2 = b.stretched2(w) / squared(w.z);
    return constant(0.5f) * (hn::Sqrt(constant(1) + squared(b.alpha) * tan2) - constant(1));
}

template <bool Stretched>
HWY_INLINE VF ggx_masking_shadowing(const Layers<Stretched>& b, V3 w_out, V3 w_in) {
    const VF lambda_out = ggx_lambda(b, w_out), lambda_in = ggx_lambda(b, w_in), one = constant(1);
    return one / select(b.separable, (one + lambda_out) * (one + lambda_in), one + lambda_out + lambda_in);
}

template <bool Stretched>
HWY_INLINE VF reflection_bound(const Layers<Stretched>& b, V3 w_out) {
    const VF a2 = squared(b.least_alpha());
    const VF s2 = squared(constant(1) + hn::Sqrt(squared(w_out.x) + squared(w_out.y)));
    return (constant(1) - a2) * s2 / (s2 + a2 * squared(w_out.z));
}

template <bool Stretched>
HWY_INLINE VF reflection_pdf(const Layers<Stretched>& b, V3 w_out, VF density) {
    const VF stretched_length = hn::Sqrt(squared(b.alpha) * b.stretched2(w_out) + squared(w_out.z));
    return density / (constant(2) * (reflection_bound(b, w_out) * w_out.z + stretched_length));
}

struct Values {
    V3 value;
    VF pdf;
};

template <bool Stretched>
HWY_INLINE Values evaluate_layers(const Layers<Stretched>& b, V3 w_out, V3 w_in, VF probability) {
    const V3 m = normalize(w_out + w_in);
    const VF cosine = dot(w_in, m), diffuse_pdf = w_in.z * constant(inv_pi);
    const V3 diffuse =
        b.diffuse * (diffuse_pdf * coat_transmittance(b, w_out.z) * coat_transmittance(b, w_in.z));
    const VF density = ggx_density(b, m);
    const V3 specular = schlick(b.specular_f0, b.specular_f90, cosine)
                        * (density * ggx_masking_shadowing(b, w_out, w_in) / (constant(4) * w_out.z));
    return {diffuse + specular,
            (constant(1) - probability) * diffuse_pdf + probability * reflection_pdf(b, w_out, density)};
}

/// `evaluate` of the BSDF; what is below the surface counts as black.
template <bool Stretched>
HWY_INLINE Values evaluate(const Layers<Stretched>& b, bool specular, V3 w_out, V3 w_in, VF probability) {
    const Mask above = hn::Gt(w_in.z, zero());
    const VF diffuse_pdf = w_in.z * constant(inv_pi);
    Values v{b.diffuse * diffuse_pdf, diffuse_pdf};
    if (specular) v = evaluate_layers(b, w_out, w_in, probability);
    return {{hn::IfThenElseZero(above, v.value.x), hn::IfThenElseZero(above, v.value.y),
             hn::IfThenElseZero(above, v.value.z)},
            hn::IfThenElseZero(above, v.pdf)};
}

struct SinesCosines {
    VF sine, cosine;
};

HWY_INLINE SinesCosines sine_cosine_of_octant(VF x) {
    const VF x2 = squared(x), one = constant(1);
    const VF sine =
        one
        - x2
              * (constant(1.0f / 6)
                 - x2 * (constant(1.0f / 120) - x2 * (constant(1.0f / 5040) - x2 * constant(1.0f / 362880))));
    const VF cosine =
        one
        - x2
              * (constant(1.0f / 2)
                 - x2
                       * (constant(1.0f / 24)
                          - x2
                                * (constant(1.0f / 720)
                                   - x2 * (constant(1.0f / 40320) - x2 * constant(1.0f / 3628800)))));
    return {x * sine, cosine};
}

HWY_INLINE SinesCosines sine_cosine_of_turns(VF turns) {
    const VI quarter = hn::ConvertTo(I(), constant(4) * turns + constant(0.5f));
    const auto [sine, cosine] =
        sine_cosine_of_octant(constant(2 * pi) * (turns - constant(0.25f) * hn::ConvertTo(F(), quarter)));
    const auto has_bit = [](VI x, int bit) {
        return hn::RebindMask(F(), hn::Ne(hn::And(x, hn::Set(I(), bit)), hn::Zero(I())));
    };
    const Mask swapped = has_bit(quarter, 1);
    const VF s = select(swapped, cosine, sine), c = select(swapped, sine, cosine);
    return {select(has_bit(quarter, 2), hn::Neg(s), s),
            select(has_bit(quarter + hn::Set(I(), 1), 2), hn::Neg(c), c)};
}

HWY_INLINE V3 cosine_hemisphere(VF u_x, VF u_y) {
    const VF x = constant(2) * u_x - constant(1), y = constant(2) * u_y - constant(1);
    const Mask wide = hn::Gt(hn::Abs(x), hn::Abs(y));
    const VF r = select(wide, x, y), other = select(wide, y, x);
    const Mask center = hn::Eq(r, zero());
    const auto [sine, cosine] =
        sine_cosine_of_octant(constant(pi / 4) * hn::IfThenZeroElse(center, other / r));
    const VF dx = r * select(wide, cosine, sine), dy = r * select(wide, sine, cosine);
    return {dx, dy, hn::Sqrt(hn::Max(zero(), constant(1) - squared(dx) - squared(dy)))};
}

HWY_INLINE V3 sample_cap(VF lowest, VF u_x, VF u_y) {
    const auto [sine, cosine] = sine_cosine_of_turns(u_x);
    const VF z = (constant(1) - u_y) * (constant(1) + lowest) - lowest;
    const VF r = hn::Sqrt(hn::Max(zero(), constant(1) - squared(z)));
    return {r * cosine, r * sine, z};
}

template <bool Stretched>
HWY_INLINE V3 sample_reflection(const Layers<Stretched>& b, V3 w_out, VF u_x, VF u_y) {
    const V3 stretched = normalize(b.roughened(w_out));
    const V3 m = sample_cap(reflection_bound(b, w_out) * stretched.z, u_x, u_y) + stretched;
    const V3 normal = normalize(b.roughened({m.x, m.y, hn::Max(m.z, constant(1e-12f))}));
    return normal * (constant(2) * dot(w_out, normal)) - w_out;
}

struct Scattered {
    V3 w_in, weight;
    VF pdf;  // 0: absorbed
};

template <bool Stretched>
HWY_INLINE Scattered sample_diffuse(const Layers<Stretched>& b, VF u_x, VF u_y) {
    const V3 w_in = cosine_hemisphere(u_x, u_y);
    return {w_in, b.diffuse, hn::IfThenElseZero(hn::Gt(w_in.z, zero()), w_in.z * constant(inv_pi))};
}

template <bool Stretched>
HWY_INLINE Scattered sample(const Layers<Stretched>& b, bool specular, V3 w_out, VF lobe, VF u_x, VF u_y) {
    const Scattered diffuse = sample_diffuse(b, u_x, u_y);
    if (!specular) return diffuse;
    const VF probability = specular_probability(b, w_out);
    const V3 w_in = select(hn::Lt(lobe, probability), sample_reflection(b, w_out, u_x, u_y), diffuse.w_in);
    const Values v = evaluate(b, true, w_out, w_in, probability);
    const Mask lambert = hn::Eq(probability, zero());
    return {w_in, select(lambert, b.diffuse, v.value / v.pdf), select(lambert, diffuse.pdf, v.pdf)};
}

void locate_lanes(const TriangleLanes& in, VertexLanes& out) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(F())) {
        const V3 a = load(in.corners[0], i), b = load(in.corners[1], i), c = load(in.corners[2], i);
        const VF u = load(in.u, i), v = load(in.v, i);
        const V3 w_out = -load(in.ray_direction, i), normal = load(in.normal, i);
        store(a * (constant(1) - u - v) + b * u + c * v, out.position, i);
        store(constant(rounding_units) * hn::Max(hn::Max(max_abs(a), max_abs(b)), max_abs(c)), out.offset, i);
        const V3 front_normal = normalize(cross(b - a, c - a)) * load(in.winding, i);
        const Mask front = hn::Ge(dot(front_normal, w_out), zero());
        const V3 geometric_normal = select(front, front_normal, -front_normal);
        store(geometric_normal, out.geometric_normal, i);
        const Mask smooth = hn::Gt(dot(normal, normal), zero());
        V3 n = select(smooth, normalize(normal), front_normal);
        n = select(front, n, -n);
        n = select(hn::Lt(dot(n, geometric_normal), zero()), -n, n);
        n = keep_viewer_above(n, w_out);
        Frames frame = frame_around(n);
        if (in.oriented) frame = frame_along(n, load(in.lobe_axis, i), frame);
        store(frame.s, out.s, i);
        store(frame.t, out.t, i);
        store(frame.n, out.n, i);
        store(to_local(frame, w_out), out.w_out, i);
    }
}

/// Stores shadow rays; no ray where `wanted` does not hold.
HWY_INLINE void store_shadow_rays(const Vertices& vertex, const LightLanes& lights, V3 w_in, Mask wanted,
                                  RayLanes& rays, std::size_t i) {
    const VF endless = constant(infinity);
    const V3 origin = ray_origin(vertex, w_in), way = load(lights.target, i) - origin;
    const VF distance = length(way);
    const Mask finite = hn::Lt(load(lights.distance, i), endless);
    const Mask bent = hn::And(finite, hn::Gt(distance, zero()));
    store(origin, rays.origin, i);
    store(select(bent, way / distance, w_in), rays.direction, i);
    store(select(wanted, select(finite, distance, endless), constant(-1)), rays.t_max, i);
}

template <bool Stretched>
HWY_NOINLINE void propose_all(const VertexLanes& vertices, const LayerLanes& layers, const LightLanes& lights,
                              const SpectrumLanes& throughput, ShadowLanes& shadows) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(F())) {
        const Vertices vertex(vertices, i);
        const Layers<Stretched> bsdf(layers, i);
        const V3 w_in = load(lights.w_in, i), w_local = to_local(vertex.frame, w_in);
        const VF light_pdf = load(lights.pdf, i), one = constant(1);
        const VF probability = layers.specular ? specular_probability(bsdf, vertex.w_out) : zero();
        const Values v = evaluate(bsdf, layers.specular, vertex.w_out, w_local, probability);
        const V3 reflected = v.value * load(lights.radiance, i);
        const VF mis = one / (one + squared(v.pdf / light_pdf));
        const VF weight = select(load(lights.delta, i), one, mis) / light_pdf;
        const Mask wanted =
            hn::AndNot(is_black(reflected), hn::And(load(lights.drawn, i), sides_agree(vertex, w_in)));
        store(load(throughput, i) * (reflected * weight), shadows.radiance, i);
        store_shadow_rays(vertex, lights, w_in, wanted, shadows.rays, i);
    }
}

void propose_lanes(const VertexLanes& vertices, const LayerLanes& layers, const LightLanes& lights,
                   const SpectrumLanes& throughput, ShadowLanes& shadows) {
    if (layers.stretched)
        propose_all<true>(vertices, layers, lights, throughput, shadows);
    else
        propose_all<false>(vertices, layers, lights, throughput, shadows);
}

struct Survival {
    Mask alive;
    V3 throughput;
};

/// Russian roulette.
HWY_INLINE Survival survive(const ScatterNumbers& numbers, const PathLanes& paths, Mask alive, V3 throughput,
                            std::size_t i) {
    const VF survival =
        hn::Min(max_component(throughput) * load(paths.eta_scale, i), constant(numbers.max_survival));
    return {hn::And(alive, hn::Lt(load(numbers.roulette, i), survival)),
            throughput * (constant(1) / survival)};
}

template <bool Stretched>
HWY_NOINLINE void scatter_all(const VertexLanes& vertices, const LayerLanes& layers,
                              const ScatterNumbers& numbers, const LaneMask& lanes, PathLanes& paths) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(F())) {
        const Mask wanted = load(lanes, i);
        const Vertices vertex(vertices, i);
        const Scattered s =
            sample(Layers<Stretched>(layers, i), layers.specular, vertex.w_out, load(numbers.lobe, i),
                   load(numbers.direction_x, i), load(numbers.direction_y, i));
        const V3 w_in = to_world(vertex.frame, s.w_in), before = load(paths.throughput, i);
        V3 throughput = before * s.weight;
        Mask alive = hn::And(wanted, hn::AndNot(is_black(s.weight), hn::Gt(s.pdf, zero())));
        alive = hn::And(alive, sides_agree(vertex, w_in));
        if (numbers.may_end) {
            const Survival end = survive(numbers, paths, alive, throughput, i);
            alive = end.alive;
            throughput = end.throughput;
        }
        const VF unlimited = constant(infinity);
        store(select(wanted, throughput, before), paths.throughput, i);
        store(select(wanted, s.pdf, load(paths.bsdf_pdf, i)), paths.bsdf_pdf, i);
        store(select(wanted, ray_origin(vertex, w_in), load(paths.ray.origin, i)), paths.ray.origin, i);
        store(select(wanted, w_in, load(paths.ray.direction, i)), paths.ray.direction, i);
        store(select(wanted, unlimited, load(paths.ray.t_max, i)), paths.ray.t_max, i);
        store(hn::Or(alive, hn::AndNot(wanted, load(paths.alive, i))), paths.alive, i);
    }
}

void scatter_lanes(const VertexLanes& vertices, const LayerLanes& layers, const ScatterNumbers& numbers,
                   const LaneMask& lanes, PathLanes& paths) {
    if (layers.stretched)
        scatter_all<true>(vertices, layers, numbers, lanes, paths);
    else
        scatter_all<false>(vertices, layers, numbers, lanes, paths);
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(locate_lanes);
HWY_EXPORT(propose_lanes);
HWY_EXPORT(scatter_lanes);

void locate(const TriangleLanes& triangles, VertexLanes& vertices) {
    HWY_DYNAMIC_DISPATCH(locate_lanes)(triangles, vertices);
}

void propose_direct_light(const VertexLanes& vertices, const LayerLanes& layers, const LightLanes& lights,
                          const SpectrumLanes& throughput, ShadowLanes& shadows) {
    HWY_DYNAMIC_DISPATCH(propose_lanes)(vertices, layers, lights, throughput, shadows);
}

void scatter(const VertexLanes& vertices, const LayerLanes& layers, const ScatterNumbers& numbers,
             const LaneMask& lanes, PathLanes& paths) {
    HWY_DYNAMIC_DISPATCH(scatter_lanes)(vertices, layers, numbers, lanes, paths);
}

}  // namespace relumine
#endif  // HWY_ONCE
