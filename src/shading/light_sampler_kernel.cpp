// SPDX-License-Identifier: Apache-2.0
// Light samples on triangles in SIMD lanes: formulas and order of operations as in light_sampler.cpp and
// sampling.hpp, so that the bits are the same.
#include "shading/light_sampler.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shading/light_sampler_kernel.cpp"
#include <hwy/foreach_target.h>  // compiles this file once per instruction set
#include <hwy/highway.h>

#include "base/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace relumine {
namespace HWY_NAMESPACE {
namespace {

/// uniform_triangle of the light's numbers, as a point in space.
HWY_INLINE V3 point_on_triangle(const TrianglePointLanes& points, std::size_t i) {
    const VF u_x = load(points.u_x, i), u_y = load(points.u_y, i), half = constant(0.5f);
    const Mask upper = hn::Gt(u_y, u_x);
    const VF b1 = select(upper, half * u_x, u_x - half * u_y);
    const VF b2 = select(upper, u_y - half * u_x, half * u_y);
    return load(points.corner, i) + load(points.edge1, i) * b1 + load(points.edge2, i) * b2;
}

void sample_triangle_lanes(const TrianglePointLanes& points, const Vec3Lanes& from, LightLanes& out) {
    for (std::size_t i = 0; i < packet_size; i += hn::Lanes(F())) {
        const Mask chosen = load(points.chosen, i);
        const V3 point = point_on_triangle(points, i), normal = load(points.normal, i);
        const V3 to_light = point - load(from, i);
        const VF distance2 = dot(to_light, to_light), height = dot(to_light, normal);
        const Mask front = hn::Lt(height, zero());
        const VF distance = hn::Sqrt(distance2);
        const VF density = load(points.density, i) * distance2 * distance / hn::Abs(height);
        const VF offset = load(points.offset, i);
        Mask drawn = hn::And(chosen, hn::Or(front, load(points.double_sided, i)));
        drawn = hn::And(drawn, hn::And(hn::Ne(height, zero()), hn::Gt(distance2, zero())));
        drawn = hn::And(drawn, hn::Gt(density, zero()));
        store(select(chosen, to_light / distance, load(out.w_in, i)), out.w_in, i);
        store(select(chosen, point + normal * select(front, offset, hn::Neg(offset)), load(out.target, i)),
              out.target, i);
        store(select(chosen, distance, load(out.distance, i)), out.distance, i);
        store(select(chosen, load(points.radiance, i), load(out.radiance, i)), out.radiance, i);
        store(select(chosen, density, load(out.pdf, i)), out.pdf, i);
        store(hn::AndNot(chosen, load(out.delta, i)), out.delta, i);
        store(hn::Or(drawn, hn::AndNot(chosen, load(out.drawn, i))), out.drawn, i);
    }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace relumine
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace relumine {

HWY_EXPORT(sample_triangle_lanes);

void sample_triangles(const TrianglePointLanes& points, const Vec3Lanes& from, LightLanes& samples) {
    HWY_DYNAMIC_DISPATCH(sample_triangle_lanes)(points, from, samples);
}

}  // namespace relumine
#endif  // HWY_ONCE
