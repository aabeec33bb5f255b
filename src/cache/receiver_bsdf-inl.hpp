// SPDX-License-Identifier: Apache-2.0
// f·|cos θ| of a ReceiverBsdf: the formulas of shading/metallic_roughness.cpp, coated_layers.cpp and
// coated_diffuse.cpp for as many directions as the machine has lanes.
#if defined(RELUMINE_CACHE_RECEIVER_BSDF_INL_HPP) == defined(HWY_TARGET_TOGGLE)
#ifdef RELUMINE_CACHE_RECEIVER_BSDF_INL_HPP
#undef RELUMINE_CACHE_RECEIVER_BSDF_INL_HPP
#else
#define RELUMINE_CACHE_RECEIVER_BSDF_INL_HPP
#endif

#include <hwy/highway.h>

#include <array>

#include "cache/receiver_bsdf.hpp"
#include "shading/coat.hpp"
// Behind the first of these:
#include <hwy/contrib/math/math-inl.h>

HWY_BEFORE_NAMESPACE();
namespace relumine::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using VF = hn::Vec<F>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }
HWY_INLINE VF squared(VF x) { return hn::Mul(x, x); }

struct Vec3s {
    VF x, y, z;
};
HWY_INLINE VF dot(const Vec3s& a, Vec3 b) {
    return hn::MulAdd(a.x, constant(b.x), hn::MulAdd(a.y, constant(b.y), hn::Mul(a.z, constant(b.z))));
}

struct Spectrums {
    VF r, g, b;
};
/// Schlick's Fresnel from (1 − cos)⁵.
HWY_INLINE Spectrums schlick(Spectrum f0, Spectrum f90, VF grazing) {
    const auto channel = [&](float at0, float at90) {
        return hn::MulAdd(constant(at90 - at0), grazing, constant(at0));
    };
    return {channel(f0.r, f90.r), channel(f0.g, f90.g), channel(f0.b, f90.b)};
}

/// What BSDFs need of the formulas: one GGX lobe that is round, one of two roughnesses, or all there is.
enum class Shape : std::uint8_t { round, stretched, layered };

Shape shape_of(const ReceiverBsdf& b) {
    if (is_layered(b)) return Shape::layered;
    return is_anisotropic(b.ggx) ? Shape::stretched : Shape::round;
}

/// What of a GGX lobe does not depend on w_in.
struct PreparedLobe {
    Ggx ggx;
    float a2, lambda_out, scale;  // D·G without what follows from w_in

    PreparedLobe(const Ggx& lobe, LocalDir w_out) : ggx(lobe), a2(sqr(lobe.alpha)) {
        const float o = w_out.v.z;
        lambda_out = 0.5f * (std::sqrt(1 + a2 * stretched2(ggx, w_out) / sqr(o)) - 1);
        scale = a2 * inv_pi / (4 * o);
    }
};

/// grazing_albedo() of one roughness.
struct PreparedGrazing {
    float flat = 0, steep = 1, inverse_steep = 1;

    PreparedGrazing() = default;
    explicit PreparedGrazing(float alpha)
        : flat(std::max(1 - 6 * alpha, 0.0f)),
          steep(20 * sqr(alpha) / (alpha + 0.02f)),
          inverse_steep(1 / steep) {}
};

/// What does not depend on w_in.
struct PreparedBase {
    const ReceiverBsdf& b;
    PreparedLobe specular;
    std::array<PreparedGrazing, 3> coat;  // for the mean α and both others
    Spectrum diffuse;                     // times what the coat lets pass to w_out

    explicit PreparedBase(const ReceiverBsdf& bsdf) : b(bsdf), specular(bsdf.ggx, bsdf.w_out) {
        const std::array<float, 3> alphas = grazing_alphas(b.ggx);
        for (std::size_t i = 0; i < alphas.size(); ++i) coat[i] = PreparedGrazing(alphas[i]);
        diffuse = b.diffuse;
        if (b.coated)
            diffuse *=
                1
                - std::min(
                    1.0f,
                    max_component(b.coat_f0 + (b.coat_f90 - b.coat_f0) * grazing_albedo(b.w_out.v.z, b.ggx)));
    }
};

template <Shape>
struct Prepared : PreparedBase {
    using PreparedBase::PreparedBase;
};

/// x² + y² with the axes scaled, where lobes are `Stretched`.
template <bool Stretched>
HWY_INLINE VF surface_length2(VF x, VF y, float scale_x, float scale_y) {
    if constexpr (Stretched) {
        x = hn::Mul(x, constant(scale_x));
        y = hn::Mul(y, constant(scale_y));
    }
    return hn::MulAdd(x, x, squared(y));
}

/// 1 − cos, as grazing_albedo() has it.
HWY_INLINE VF grazing_of(VF cosine) {
    return hn::Min(hn::Max(hn::Sub(constant(1), cosine), constant(1e-3f)), constant(1));
}

HWY_INLINE VF grazing_albedo_at(const PreparedGrazing& g, VF beside, VF beside2) {
    // Rough coats are steep alone: no division.
    const VF whole = g.flat == 0 ? hn::Mul(hn::Mul(beside2, beside), constant(g.inverse_steep))
                                 : hn::Div(hn::Mul(squared(beside2), beside),
                                           hn::MulAdd(constant(g.steep), beside2, constant(g.flat)));
    return hn::Min(whole, constant(1));
}

/// The coat's grazing albedo.
template <bool Stretched>
HWY_INLINE VF coat_grazing_albedo(const PreparedBase& p, VF cosine) {
    const VF beside = grazing_of(cosine);
    const VF beside2 = squared(beside);
    const auto at = [&](std::size_t i) { return grazing_albedo_at(p.coat[i], beside, beside2); };
    if constexpr (!Stretched) return at(0);
    return hn::Max(at(0), hn::Max(at(1), at(2)));
}

/// What the base's coat lets pass.
template <bool Stretched>
HWY_INLINE VF coat_transmittance(const PreparedBase& p, VF cosine) {
    const Spectrums coat = schlick(p.b.coat_f0, p.b.coat_f90, coat_grazing_albedo<Stretched>(p, cosine));
    const VF most = hn::Max(coat.r, hn::Max(coat.g, coat.b));
    return hn::Max(hn::Sub(constant(1), most), constant(0));
}

/// w_out + w_in by what lobes need of it.
struct HalfVector {
    Vec3s m;
    VF xy2, z2, length2;

    HWY_INLINE HalfVector(LocalDir w_out, const Vec3s& w)
        : m{hn::Add(w.x, constant(w_out.v.x)), hn::Add(w.y, constant(w_out.v.y)),
            hn::Add(w.z, constant(w_out.v.z))},
          xy2(hn::MulAdd(m.x, m.x, squared(m.y))),
          z2(squared(m.z)),
          length2(hn::Max(hn::Add(xy2, z2), constant(1e-20f))) {}

    /// Schlick's (1 − cos)⁵: |w_out + w_in| / 2 = cos of the angle between either and the half vector.
    [[nodiscard]] HWY_INLINE VF grazing() const {
        const VF x = hn::Max(hn::NegMulAdd(hn::Sqrt(length2), constant(0.5f), constant(1)), constant(0));
        return hn::Mul(squared(squared(x)), x);
    }
};

/// D·G / (4 cos θ_out). One division for those of the density, of Λ and of the masking.
template <bool Stretched>
HWY_INLINE VF lobe(const PreparedLobe& p, const Vec3s& w, const HalfVector& half) {
    // The axes are squeezed in the density, against Λ's.
    const VF m_xy2 = Stretched
                         ? surface_length2<Stretched>(half.m.x, half.m.y, p.ggx.stretch_y, p.ggx.stretch_x)
                         : half.xy2;
    const VF density_root = hn::MulAdd(constant(p.a2), half.z2, m_xy2);
    const VF z2 = squared(w.z);
    const VF xy2 = surface_length2<Stretched>(w.x, w.y, p.ggx.stretch_x, p.ggx.stretch_y);
    const VF root = hn::Sqrt(hn::MulAdd(constant(p.a2), xy2, z2));
    // (½ + Λ_in)·cos θ_in = root / 2
    const VF masking = p.ggx.masking == Masking::correlated
                           ? hn::MulAdd(constant(0.5f + p.lambda_out), w.z, hn::Mul(constant(0.5f), root))
                           : hn::Mul(constant(0.5f * (1 + p.lambda_out)), hn::Add(w.z, root));
    return hn::Div(hn::Mul(hn::Mul(constant(p.scale), w.z), squared(half.length2)),
                   hn::Mul(squared(density_root), masking));
}

HWY_INLINE Spectrums scaled(Spectrum s, VF by) {
    return {hn::Mul(by, constant(s.r)), hn::Mul(by, constant(s.g)), hn::Mul(by, constant(s.b))};
}
HWY_INLINE Spectrums mul_add(VF value, const Spectrums& s, const Spectrums& to) {
    return {hn::MulAdd(value, s.r, to.r), hn::MulAdd(value, s.g, to.g), hn::MulAdd(value, s.b, to.b)};
}

template <Shape shape>
HWY_INLINE Spectrums reflect(const Prepared<shape>& p, const Vec3s& w) {
    constexpr bool stretched = shape == Shape::stretched;
    const ReceiverBsdf& b = p.b;
    const VF cosine = hn::Mul(w.z, constant(inv_pi));
    if (!b.specular && !b.coated) return scaled(p.diffuse, cosine);
    VF base = cosine;
    if (b.coated) base = hn::Mul(base, coat_transmittance<stretched>(p, w.z));
    const Spectrums out = scaled(p.diffuse, base);
    if (!b.specular) return out;
    const HalfVector half(b.w_out, w);
    return mul_add(lobe<stretched>(p.specular, w, half),
                   schlick(b.specular_f0, b.specular_f90, half.grazing()), out);
}

/// fresnel_dielectric().
HWY_INLINE VF fresnel(float eta, VF cosine) {
    const VF beside2 = hn::Max(hn::NegMulAdd(cosine, cosine, constant(1)), constant(0));
    const VF transmitted =
        hn::Sqrt(hn::Max(hn::NegMulAdd(beside2, constant(1 / sqr(eta)), constant(1)), constant(0)));
    const VF a = hn::Mul(constant(eta), cosine), b = hn::Mul(constant(eta), transmitted);
    const VF parallel = hn::Div(hn::Sub(a, transmitted), hn::Add(a, transmitted));
    const VF perpendicular = hn::Div(hn::Sub(cosine, b), hn::Add(cosine, b));
    return hn::Mul(constant(0.5f), hn::MulAdd(parallel, parallel, squared(perpendicular)));
}

/// The functions of one direction that sheen is made of.
struct PreparedSheen {
    SheenCurves curves{};
    float exponent = 0, scale = 0;  // of its density, which is that of half vectors

    PreparedSheen() = default;
    explicit PreparedSheen(float alpha)
        : curves(sheen_curves(alpha)), exponent(0.5f / alpha), scale((2 + 1 / alpha) * 0.5f * inv_pi) {}

    /// Of the lobe as published, which exceeds 1 at grazing angles.
    [[nodiscard]] HWY_INLINE VF albedo(VF cosine) const {
        const F f;
        const hn::RebindToSigned<F> i;
        const VF at =
            hn::Mul(hn::Sqrt(hn::Min(cosine, constant(1))), constant(static_cast<float>(sheen_cosines - 1)));
        const auto entry = hn::Min(hn::ConvertTo(i, at), hn::Set(i, sheen_cosines - 2));
        const VF beyond = hn::Sub(at, hn::ConvertTo(f, entry));
        const VF low = hn::GatherIndex(f, curves.albedo.data(), entry),
                 high = hn::GatherIndex(f, curves.albedo.data() + 1, entry);
        return hn::MulAdd(beyond, hn::Sub(high, low), low);
    }
    [[nodiscard]] HWY_INLINE VF lambda(VF cosine) const {
        const F f;
        const VF beside = hn::Max(hn::Sub(constant(1), cosine), constant(0));
        const VF exponents = log_lambda(hn::Min(cosine, beside));
        const VF mirrored = hn::Sub(hn::Mul(constant(2), log_lambda(constant(0.5f))), exponents);
        return hn::Exp(f, hn::IfThenElse(hn::Lt(cosine, constant(0.5f)), exponents, mirrored));
    }
    [[nodiscard]] HWY_INLINE VF density(const HalfVector& half) const {
        const VF sine2 = hn::Max(hn::Div(half.xy2, half.length2), constant(1e-20f));
        return hn::Mul(constant(scale), power(sine2, exponent));
    }

  private:
    [[nodiscard]] HWY_INLINE VF log_lambda(VF x) const {
        const VF fall =
            hn::MulAdd(constant(curves.b), power(hn::Max(x, constant(2e-38f)), curves.c), constant(1));
        return hn::Add(hn::Div(constant(curves.a), fall),
                       hn::MulAdd(constant(curves.d), x, constant(curves.e)));
    }
    static HWY_INLINE VF power(VF x, float exponent) {
        const F f;
        return hn::Exp(f, hn::Mul(constant(exponent), hn::Log(f, x)));
    }
};

/// Transmittances of what lies over each part, from one direction.
struct Through {
    VF clearcoat, lobes, diffuse;
};

template <>
struct Prepared<Shape::layered> : PreparedBase {
    PreparedLobe clearcoat;
    PreparedGrazing clearcoat_grazing;
    PreparedSheen sheen;
    float clearcoat_out, lobes_out;  // transmittances to w_out
    float sheen_albedo_out = 1, sheen_lambda_out = 0;

    explicit Prepared(const ReceiverBsdf& bsdf)
        : PreparedBase(bsdf),
          clearcoat({bsdf.over.clearcoat_alpha, bsdf.over.clearcoat_masking}, bsdf.w_out),
          clearcoat_grazing(bsdf.over.clearcoat_alpha),
          sheen(bsdf.over.sheen > 0 ? PreparedSheen(bsdf.over.sheen_alpha) : PreparedSheen()) {
        const VF cosine = constant(b.w_out.v.z);
        const Through out = through(cosine);
        clearcoat_out = hn::GetLane(out.clearcoat);
        lobes_out = hn::GetLane(out.lobes);
        diffuse = b.diffuse * hn::GetLane(out.diffuse);
        if (!has_sheen_lobe(b)) return;
        sheen_albedo_out = hn::GetLane(sheen.albedo(cosine));
        sheen_lambda_out = hn::GetLane(sheen.lambda(cosine));
    }

    [[nodiscard]] HWY_INLINE Through through(VF cosine) const {
        Through t{constant(1), constant(1), constant(1)};
        if (b.over.eta > 0) {
            t.diffuse = hn::Sub(constant(1), fresnel(b.over.eta, cosine));
            return t;
        }
        if (b.over.clearcoat > 0) {
            const VF beside = grazing_of(cosine);
            const VF albedo = hn::MulAdd(grazing_albedo_at(clearcoat_grazing, beside, squared(beside)),
                                         constant(1 - clearcoat_f0), constant(clearcoat_f0));
            t.clearcoat = hn::NegMulAdd(albedo, constant(b.over.clearcoat), constant(1));
        }
        t.lobes = t.clearcoat;
        if (b.over.sheen > 0) {
            const VF albedo = hn::Min(sheen.albedo(cosine), constant(1));
            t.lobes = hn::Mul(
                t.lobes, hn::Max(hn::NegMulAdd(albedo, constant(b.over.sheen), constant(1)), constant(0)));
        }
        t.diffuse = t.lobes;
        if (b.coated)
            t.diffuse = hn::Mul(t.lobes, is_anisotropic(b.ggx) ? coat_transmittance<true>(*this, cosine)
                                                               : coat_transmittance<false>(*this, cosine));
        return t;
    }

    /// D·V·cos θ_in of sheen.
    [[nodiscard]] HWY_INLINE VF sheen_value(const Vec3s& w, const HalfVector& half) const {
        const VF most = hn::Max(hn::Max(sheen.albedo(w.z), constant(sheen_albedo_out)), constant(1));
        const VF masking = hn::Add(constant(1 + sheen_lambda_out), sheen.lambda(w.z));
        return hn::Div(sheen.density(half), hn::Mul(hn::Mul(masking, constant(4 * b.w_out.v.z)), most));
    }
};

template <>
HWY_INLINE Spectrums reflect(const Prepared<Shape::layered>& p, const Vec3s& w) {
    const ReceiverBsdf& b = p.b;
    const OverLayers& over = b.over;
    const Through in = p.through(w.z);
    Spectrums out = scaled(p.diffuse, hn::Mul(hn::Mul(w.z, constant(inv_pi)), in.diffuse));
    if (!has_lobes(b)) return out;
    const HalfVector half(b.w_out, w);
    if (b.specular) {
        const VF value = hn::Mul(lobe<true>(p.specular, w, half), hn::Min(in.lobes, constant(p.lobes_out)));
        const Spectrums reflected =
            over.eta > 0
                ? scaled(Spectrum{1}, fresnel(over.eta, hn::Mul(hn::Sqrt(half.length2), constant(0.5f))))
                : schlick(b.specular_f0, b.specular_f90, half.grazing());
        out = mul_add(value, reflected, out);
    }
    if (has_sheen_lobe(b)) {
        const VF value = hn::Mul(p.sheen_value(w, half), hn::Min(in.clearcoat, constant(p.clearcoat_out)));
        out = mul_add(value, scaled(over.sheen_lobe, constant(1)), out);
    }
    if (has_clearcoat_lobe(b)) {
        const Spectrum f0{over.clearcoat_lobe * clearcoat_f0}, f90{over.clearcoat_lobe};
        out = mul_add(lobe<false>(p.clearcoat, w, half), schlick(f0, f90, half.grazing()), out);
    }
    return out;
}

template <Shape shape>
HWY_INLINE Spectrums above_horizon(const Prepared<shape>& p, const Vec3s& direction) {
    const Vec3s w{dot(direction, p.b.shading_x), dot(direction, p.b.shading_y),
                  dot(direction, p.b.shading_z)};
    const auto above = hn::Gt(w.z, constant(0));
    const Spectrums s = reflect(p, {w.x, w.y, hn::Max(w.z, constant(1e-7f))});
    return {hn::IfThenElseZero(above, s.r), hn::IfThenElseZero(above, s.g), hn::IfThenElseZero(above, s.b)};
}

}  // namespace
}  // namespace relumine::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
