// SPDX-License-Identifier: Apache-2.0
// How much the children of a light tree's node matter, side by side. Operations and their order are those of
// importance(), so the bits are, too.
#include "shading/light_tree.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/light_tree_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, light_group_size>;
using VF = hn::Vec<F>;

HWY_INLINE VF constant(float x) { return hn::Set(F(), x); }
HWY_INLINE VF load(const LightGroup::Eight<float>& values, std::size_t i) {
    return hn::LoadU(F(), &values[i]);
}

void importances_of(const LightGroup& g, Vec3 from, LightGroup::Eight<float>& values) {
    const VF zero = hn::Zero(F()), one = constant(1);
    for (std::size_t i = 0; i < light_group_size; i += hn::Lanes(F())) {
        const VF x = constant(from.x) - load(g.center_x, i), y = constant(from.y) - load(g.center_y, i),
                 z = constant(from.z) - load(g.center_z, i);
        const VF distance2 = x * x + y * y + z * z, radius = load(g.radius, i), radius2 = radius * radius;
        const VF intensity = load(g.intensity, i);
        const VF along = load(g.axis_x, i) * x + load(g.axis_y, i) * y + load(g.axis_z, i) * z;
        VF cos_w = hn::Min(hn::Max(along / hn::Sqrt(distance2), constant(-1)), one);
        const auto two_sided =
            hn::MaskFromVec(hn::BitCast(F(), hn::LoadU(hn::RebindToSigned<F>(), &g.two_sided[i])));
        cos_w = hn::IfThenElse(two_sided, hn::Abs(cos_w), cos_w);
        const VF sin_w = hn::Sqrt(hn::Max(zero, one - cos_w * cos_w));
        const VF cos_n = load(g.cos_normals, i), sin_n = load(g.sin_normals, i);
        const auto within = hn::Gt(cos_w, cos_n);
        const VF cos_x = hn::IfThenElse(within, one, cos_w * cos_n + sin_w * sin_n);
        const VF sin_x = hn::IfThenElse(within, zero, sin_w * cos_n - cos_w * sin_n);
        const VF sin2_b = radius2 / distance2, cos_b = hn::Sqrt(one - sin2_b), sin_b = hn::Sqrt(sin2_b);
        const VF cosine = hn::IfThenElse(hn::Gt(cos_x, cos_b), one, cos_x * cos_b + sin_x * sin_b);
        const VF rim = constant(light_rim);
        const VF outside = hn::IfThenElse(hn::Lt(cosine, load(g.cos_spread, i) - rim), zero,
                                          intensity * hn::Max(cosine, rim) / distance2);
        const VF inside = intensity / hn::Max(radius2, constant(least_light_radius2));
        hn::StoreU(hn::IfThenElse(hn::Gt(distance2, radius2), outside, inside), F(), &values[i]);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(importances_of);

void importances(const LightGroup& group, Vec3 from, LightGroup::Eight<float>& values) {
    HWY_DYNAMIC_DISPATCH(importances_of)(group, from, values);
}

}  // namespace relumine
#endif  // HWY_ONCE
