// SPDX-License-Identifier: Apache-2.0
// The transforms of pbrt's directives.
#include "scene/pbrt_transform.hpp"

namespace relumine {
namespace {

double length(PbrtTriple v) { return std::hypot(v[0], v[1], v[2]); }
std::optional<PbrtTriple> unit(PbrtTriple v) {
    const double l = length(v);
    if (!(l > 1e-30 && l < 1e30)) return {};
    return PbrtTriple{v[0] / l, v[1] / l, v[2] / l};
}
PbrtTriple cross(PbrtTriple a, PbrtTriple b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

Transform pbrt_translate(PbrtTriple by) {
    Transform t;
    for (std::size_t i = 0; i < 3; ++i) t.m[i][3] = by[i];
    return t;
}

Transform pbrt_scale(PbrtTriple by) {
    Transform t;
    for (std::size_t i = 0; i < 3; ++i) t.m[i][i] = by[i];
    return t;
}

Transform pbrt_rotate(double degrees, PbrtTriple axis) {
    const PbrtTriple a = unit(axis).value_or(PbrtTriple{0, 0, 1});
    const double angle = degrees * 3.14159265358979323846 / 180, s = std::sin(angle), c = std::cos(angle);
    Transform t;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) t.m[i][j] = a[i] * a[j] * (1 - c) + (i == j ? c : 0);
    for (std::size_t i = 0; i < 3; ++i) {  // the cross product with the axis
        const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
        t.m[j][i] += a[k] * s;
        t.m[i][j] -= a[k] * s;
    }
    return t;
}

std::optional<Transform> pbrt_look_at(PbrtTriple eye, PbrtTriple look, PbrtTriple up) {
    const auto direction = unit({look[0] - eye[0], look[1] - eye[1], look[2] - eye[2]});
    const auto above = unit(up);
    if (!direction || !above) return {};
    const PbrtTriple across = cross(*above, *direction);
    const auto right = length(across) > 1e-9 ? unit(across) : std::nullopt;
    if (!right) return {};
    const PbrtTriple true_up = cross(*direction, *right);
    Transform world_from_camera;
    for (std::size_t i = 0; i < 3; ++i)
        world_from_camera.m[i] = {(*right)[i], true_up[i], (*direction)[i], eye[i]};
    return inverse(world_from_camera);
}

std::optional<Transform> inverse(const Transform& t) {
    double lengths = 1;
    for (std::size_t j = 0; j < 3; ++j) lengths *= std::hypot(t.m[0][j], t.m[1][j], t.m[2][j]);
    const double det = determinant(t);
    if (!(std::abs(det) > 1e-12 * lengths) || !std::isfinite(det)) return {};
    const Transform c = cofactor(t);
    Transform inverse;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) inverse.m[i][j] = c.m[j][i] / det;
    for (std::size_t i = 0; i < 3; ++i)
        inverse.m[i][3] =
            -(inverse.m[i][0] * t.m[0][3] + inverse.m[i][1] * t.m[1][3] + inverse.m[i][2] * t.m[2][3]);
    return inverse;
}

}  // namespace relumine
