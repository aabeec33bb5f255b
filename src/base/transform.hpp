// SPDX-License-Identifier: Apache-2.0
// Affine transforms, kept in double so that deep hierarchies far from the origin stay exact enough.
#pragma once

#include <array>
#include <cmath>

#include "base/vec.hpp"

namespace relumine {

/// Maps points of one space to another: p' = A p + b. Read products right to left: world_from_local *
/// local_from_…
struct Transform {
    // rows of [A | b]
    std::array<std::array<double, 4>, 3> m{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

    [[nodiscard]] Vec3 point(Vec3 p) const { return apply(p, 1); }
    [[nodiscard]] Vec3 vector(Vec3 v) const { return apply(v, 0); }
    bool operator==(const Transform&) const = default;

  private:
    [[nodiscard]] Vec3 apply(Vec3 p, double w) const {
        const auto row = [&](const std::array<double, 4>& r) {
            return static_cast<float>(r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3] * w);
        };
        return {row(m[0]), row(m[1]), row(m[2])};
    }
};

inline Transform operator*(const Transform& a, const Transform& b) {
    Transform product;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 4; ++j)
            product.m[i][j] = a.m[i][0] * b.m[0][j] + a.m[i][1] * b.m[1][j] + a.m[i][2] * b.m[2][j]
                              + (j == 3 ? a.m[i][3] : 0);
    return product;
}

/// From a column-major 4 × 4 affine matrix, as glTF stores it.
inline Transform transform_from_columns(const std::array<double, 16>& c) {
    Transform t;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 4; ++j) t.m[i][j] = c[4 * j + i];
    return t;
}

/// The cofactor matrix of the linear part: maps normals (unnormalised), det(A)·A⁻ᵀ; exists for singular A
/// too.
inline Transform cofactor(const Transform& t) {
    const auto& m = t.m;
    const auto minor = [&](size_t i, size_t j) {
        const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        return m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    };
    Transform c;
    for (size_t i = 0; i < 3; ++i)
        for (size_t j = 0; j < 3; ++j) c.m[i][j] = minor(i, j);
    return c;
}

/// Volume scale; negative where handedness flips, 0 where the transform is singular.
inline double determinant(const Transform& t) {
    const auto& m = t.m;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1])
           - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0])
           + m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

}  // namespace relumine
