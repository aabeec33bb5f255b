// SPDX-License-Identifier: Apache-2.0
// Mitsuba's transforms: translate, rotate, scale, matrix and lookat, one after the other.
#include <fmt/format.h>

#include <cmath>

#include "scene/mitsuba_properties.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using Triple = std::array<double, 3>;

/// x, y and z, or all of `value`; one number in `value` stands for all three.
Triple triple(const MitsubaElement& e, double otherwise) {
    const std::string what = fmt::format("numbers for <{}>", e.tag);
    if (e.attributes.contains("value")) {
        const std::vector<double> v = mitsuba_numbers(e.attribute("value"), e.place, what);
        if (v.size() == 1 && e.tag == "scale") return {v[0], v[0], v[0]};
        if (v.size() != 3)
            refuse_pbrt(e.place, fmt::format("three numbers for <{}>", e.tag), fmt::format("{}", v.size()));
        return {v[0], v[1], v[2]};
    }
    Triple t{otherwise, otherwise, otherwise};
    const std::array<const char*, 3> axes{"x", "y", "z"};
    for (std::size_t i = 0; i < 3; ++i) {
        if (!e.attributes.contains(axes[i])) continue;
        const std::vector<double> v = mitsuba_numbers(e.attribute(axes[i]), e.place, what);
        if (v.size() != 1)
            refuse_pbrt(e.place, fmt::format("one number for {}", axes[i]), fmt::format("{}", v.size()));
        t[i] = v[0];
    }
    return t;
}

Transform rotation(const MitsubaElement& e) {
    const std::vector<double> angle = mitsuba_numbers(e.attribute("angle"), e.place, "an angle in degrees");
    if (angle.size() != 1)
        refuse_pbrt(e.place, "an angle in degrees", fmt::format("{} numbers", angle.size()));
    const Triple axis = triple(e, 0);
    const double l = std::hypot(axis[0], axis[1], axis[2]);
    if (!(l > 1e-30 && l < 1e30))
        refuse_pbrt(e.place, "an axis that is not 0",
                    fmt::format("{:g} {:g} {:g}", axis[0], axis[1], axis[2]));
    return pbrt_rotate(angle[0], axis);
}

/// Row by row: 16 numbers with 0 0 0 1 at the end, or the 9 of a linear map.
Transform matrix(const MitsubaElement& e) {
    const std::vector<double> v = mitsuba_numbers(e.attribute("value"), e.place, "16 numbers for <matrix>");
    Transform t;
    if (v.size() == 9) {
        for (std::size_t i = 0; i < 9; ++i) t.m[i / 3][i % 3] = v[i];
        return t;
    }
    if (v.size() != 16) refuse_pbrt(e.place, "16 or 9 numbers for <matrix>", fmt::format("{}", v.size()));
    if (v[12] != 0 || v[13] != 0 || v[14] != 0 || v[15] != 1)
        refuse_pbrt(e.place, "an affine matrix, whose last row is 0 0 0 1",
                    fmt::format("{:g} {:g} {:g} {:g}", v[12], v[13], v[14], v[15]));
    for (std::size_t i = 0; i < 12; ++i) t.m[i / 4][i % 4] = v[i];
    return t;
}

Transform look_at(const MitsubaElement& e) {
    const auto point = [&](const char* name) {
        const std::string what = fmt::format("three numbers for {}", name);
        const std::vector<double> v = mitsuba_numbers(e.attribute(name), e.place, what);
        if (v.size() != 3) refuse_pbrt(e.place, what, fmt::format("{}", v.size()));
        return Triple{v[0], v[1], v[2]};
    };
    const Triple origin = point("origin"), target = point("target");
    Triple up{};
    if (e.attributes.contains("up")) up = point("up");
    if (up == Triple{}) {
        Triple d{target[0] - origin[0], target[1] - origin[1], target[2] - origin[2]};
        const double l = std::hypot(d[0], d[1], d[2]);
        if (l > 0) up = mitsuba_frame({d[0] / l, d[1] / l, d[2] / l})[0];
    }
    const std::optional<Transform> camera_from_world = pbrt_look_at(origin, target, up);
    const auto world_from_camera = camera_from_world ? inverse(*camera_from_world) : std::nullopt;
    if (!world_from_camera)
        refuse_pbrt(e.place, "origin and target apart, and up not along their line", "them on one line");
    return *world_from_camera;  // X to the left, Y up, Z ahead
}

Transform step(const MitsubaElement& e) {
    if (e.tag == "translate") return pbrt_translate(triple(e, 0));
    if (e.tag == "scale") return pbrt_scale(triple(e, 1));
    if (e.tag == "rotate") return rotation(e);
    return e.tag == "matrix" ? matrix(e) : look_at(e);
}

}  // namespace

Transform mitsuba_transform(const MitsubaElement& element) {
    Transform t;
    for (const auto& child : element.children) t = step(*child) * t;
    for (const auto& row : t.m)
        for (const double x : row)
            if (!(std::abs(x) < 1e30))
                refuse_pbrt(element.place, "a transform with numbers below 1e30", "larger ones");
    return t;
}

std::array<Triple, 2> mitsuba_frame(const Triple& n) {
    const double sign = std::copysign(1.0, n[2]), a = -1 / (sign + n[2]), b = n[0] * n[1] * a;
    return {{{1 + sign * n[0] * n[0] * a, sign * b, -sign * n[0]}, {b, sign + n[1] * n[1] * a, -n[1]}}};
}

}  // namespace relumine
