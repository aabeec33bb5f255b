// SPDX-License-Identifier: Apache-2.0
// What holds for every transform: normals, frames, instances; RapidCheck draws random ones, mirrored and flat
// ones too.
#include <gtest/gtest.h>

#include "base/frame.hpp"
#include "base/transform.hpp"
#include "cache/hemisphere_map.hpp"
#include "cache/reproject.hpp"
#include "scene/scene_data.hpp"
#include "shading/surface_point.hpp"
#include "tests/properties.hpp"

namespace relumine {
namespace {

using testing::holds;
using testing::unit_number;
using testing::within;

Vec3 random_unit() {
    const float z = *rc::gen::element(-1.0f, 1.0f, 0.0f, within(-1, 1)), phi = 2 * pi * unit_number();
    const float r = std::sqrt(std::max(0.0f, 1 - z * z));
    return normalize({r * std::cos(phi), r * std::sin(phi), z});
}

Vec3 random_point(float range) {
    return {within(-range, range), within(-range, range), within(-range, range)};
}

/// Turned, stretched by factors between 0.05 and 20, perhaps mirrored, and moved.
Transform random_transform() {
    const Frame turn = frame_around(random_unit());
    const std::array<Vec3, 3> columns{turn.s, turn.t, turn.n};
    Transform turned, stretched;
    for (std::size_t j = 0; j < 3; ++j) {
        const float sign = unit_number() < 0.3f ? -1.0f : 1.0f;
        stretched.m[j][j] = static_cast<double>(sign * std::exp(within(-3, 3)));
        for (std::size_t i = 0; i < 3; ++i)
            turned.m[i][j] = static_cast<double>(columns[j][static_cast<int>(i)]);
    }
    const Vec3 shift = random_point(10);
    turned.m[0][3] = static_cast<double>(shift.x);
    turned.m[1][3] = static_cast<double>(shift.y);
    turned.m[2][3] = static_cast<double>(shift.z);
    const Frame other = frame_around(random_unit());
    Transform first;
    const std::array<Vec3, 3> rows{other.s, other.t, other.n};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) first.m[i][j] = static_cast<double>(rows[i][static_cast<int>(j)]);
    return turned * stretched * first;
}

TEST(TransformProperties, ProductsActLikeTheirFactors) {
    EXPECT_TRUE(holds("(a b) p = a (b p)", [] {
        const Transform a = random_transform(), b = random_transform();
        const Vec3 p = random_point(5), direct = (a * b).point(p), stepwise = a.point(b.point(p));
        RC_ASSERT(length(direct - stepwise) <= 2e-4f * (1 + length(direct) + 20 * length(b.point(p))));
        RC_ASSERT(std::abs(determinant(a * b) / (determinant(a) * determinant(b)) - 1) < 1e-4);
    }));
}

TEST(TransformProperties, CofactorsKeepNormalsUpright) {
    const auto upright = [](bool as_vector) {
        return holds("normals stay perpendicular and on their side", [=] {
            const Transform t = random_transform();
            const Vec3 n = random_unit();
            const Frame frame = frame_around(n);
            const Vec3 mapped = normalize(as_vector ? t.vector(n) : cofactor(t).vector(n));
            for (const Vec3 tangent : {frame.s, frame.t})
                RC_ASSERT(std::abs(dot(mapped, normalize(t.vector(tangent)))) < 2e-3f);
            // A triangle's own normal turns over with the handedness; the cofactors follow it.
            const Vec3 of_triangle = normalize(cross(t.vector(frame.s), t.vector(frame.t)));
            RC_ASSERT(dot(mapped, of_triangle) > 0.99f);
        });
    };
    EXPECT_TRUE(upright(false));
    EXPECT_FALSE(upright(true));  // normals are no vectors: the mutant must be caught
}

TEST(TransformProperties, FramesAreOrthonormalAndGoThereAndBack) {
    EXPECT_TRUE(holds("frame_around and receiver_frame", [] {
        const Vec3 n = random_unit(), other = random_unit();
        const Frame around = frame_around(n);
        for (const Frame& f : {around, receiver_frame(around, other)}) {
            RC_ASSERT(std::abs(dot(f.s, f.t)) < 1e-5f);
            RC_ASSERT(std::abs(dot(f.s, f.n)) < 1e-5f);
            RC_ASSERT(std::abs(length(f.s) - 1) < 1e-5f);
            RC_ASSERT(length(cross(f.s, f.t) - f.n) < 1e-5f);
            const WorldDir w{random_unit()};
            RC_ASSERT(length(f.to_world(f.to_local(w)).v - w.v) < 1e-5f);
        }
        RC_ASSERT(length(receiver_frame(around, other).n - other) < 2e-3f);
    }));
}

TEST(TransformProperties, TheHemisphereMapGoesThereAndBack) {
    EXPECT_TRUE(holds("square, hemisphere, square", [] {
        const Point2 p{unit_number(), unit_number()};
        const LocalDir w = square_to_hemisphere(p);
        RC_ASSERT(w.v.z >= 0);
        RC_ASSERT(std::abs(length(w.v) - 1) < 1e-5f);
        const Point2 back = hemisphere_to_square(w);
        // Near the zenith 1 − z keeps few digits.
        RC_ASSERT(std::hypot(back.x - p.x, back.y - p.y) < 5e-4f);
    }));
}

/// A triangle with vertex normals; `baked`: moved to world space, as finish_scene does with single instances.
SceneData one_triangle(const std::array<Vec3, 3>& corners, const std::array<Vec3, 3>& normals,
                       const Transform& world_from_object, bool baked) {
    SceneData scene;
    scene.materials.emplace_back();
    Mesh mesh;
    mesh.triangles = {{{0, 1, 2}}};
    Instance instance;
    instance.identity = baked;
    if (!baked) instance.world_from_object = world_from_object;
    const double handedness = determinant(world_from_object) < 0 ? -1 : 1;
    const Transform of_normals = cofactor(world_from_object);
    for (std::size_t i = 0; i < 3; ++i) {
        mesh.positions.push_back(baked ? world_from_object.point(corners[i]) : corners[i]);
        const Vec3 n = of_normals.vector(normals[i]) * static_cast<float>(handedness);
        mesh.normals.push_back(baked ? n : normals[i]);  // of any length, so that both interpolate alike
    }
    if (baked && handedness < 0) mesh.triangles = {{{0, 2, 1}}};
    scene.meshes.push_back(mesh);
    scene.instances.push_back(instance);
    return scene;
}

TEST(TransformProperties, AnInstanceIsItsMeshMoved) {
    EXPECT_TRUE(holds("position, normals and side of an instance", [] {
        const Vec3 n = random_unit();
        const Frame frame = frame_around(n);
        const std::array<Vec3, 3> corners{frame.s, frame.t, frame.s * -1.0f - frame.t};
        std::array<Vec3, 3> normals;
        for (Vec3& normal : normals) normal = normalize(n + random_point(0.2f));
        const Transform t = random_transform();
        const float u = 0.1f + 0.3f * unit_number(), v = 0.1f + 0.3f * unit_number();
        const bool mirrored = determinant(t) < 0;
        Hit hit{1, u, v, 0, 0}, baked_hit{1, mirrored ? v : u, mirrored ? u : v, 0, 0};
        const SceneData instanced = one_triangle(corners, normals, t, false),
                        baked = one_triangle(corners, normals, t, true);
        const WorldDir viewer{random_unit()};
        const SurfacePoint a = surface_point(instanced, hit, viewer),
                           b = surface_point(baked, baked_hit, viewer);
        RC_PRE(std::abs(dot(viewer.v, a.geometric_normal)) > 0.02f);
        const float size = 1 + length(a.position);
        RC_ASSERT(length(a.position - b.position) < 1e-5f * size);
        RC_ASSERT(a.front == b.front);
        RC_ASSERT(dot(a.geometric_normal, b.geometric_normal) > 0.999f);
        RC_ASSERT(dot(a.frame.n, b.frame.n) > 0.99f);
        RC_ASSERT(dot(a.frame.n, viewer.v) > 0);
    }));
}

}  // namespace
}  // namespace relumine
