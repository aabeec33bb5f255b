// SPDX-License-Identifier: Apache-2.0
// Rays against every triangle one by one; packets against single rays; instances; opacity.
#include "trace/tracer.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"

namespace relumine {
namespace {

Vec3 random_point(std::uint32_t i, float scale) {
    const SampleStream s{11, i, 1, PointSet::independent};
    const auto [x, y] = s.next2(Dim::direction);
    return Vec3{2 * x - 1, 2 * y - 1, 2 * s.next1(Dim::lobe) - 1} * scale;
}

/// Random small triangles, as one mesh with `instances` instances beside each other.
SceneData soup(std::uint32_t triangles, int instances, AlphaMode alpha = AlphaMode::opaque) {
    SceneData scene;
    scene.materials.resize(1);
    scene.materials[0].alpha_mode = alpha;
    Mesh mesh;
    mesh.positions.reserve(3 * triangles + 2);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        const Vec3 center = random_point(i, 1);
        for (std::uint32_t corner = 0; corner < 3; ++corner)
            mesh.positions.push_back(center + random_point(1000 + 3 * i + corner, 0.2f));
        mesh.triangles.push_back({{3 * i, 3 * i + 1, 3 * i + 2}});
    }
    scene.meshes.push_back(std::move(mesh));
    for (int i = 0; i < instances; ++i) {
        Instance instance;
        instance.identity = instances == 1;
        instance.world_from_object.m[0][3] = 3.0 * i;
        scene.instances.push_back(instance);
    }
    return scene;
}

Ray random_ray(std::uint32_t i) {
    const Vec3 origin = random_point(5000 + i, 3);
    return {origin, {normalize(random_point(9000 + i, 1) - origin)}};
}

/// Möller and Trumbore's test in double.
double distance_to(const Ray& ray, Vec3 a, Vec3 b, Vec3 c) {
    const Vec3 e1 = b - a, e2 = c - a, p = cross(ray.direction.v, e2), t = ray.origin - a, q = cross(t, e1);
    const double det = dot(e1, p), u = dot(t, p) / det, v = dot(ray.direction.v, q) / det,
                 distance = dot(e2, q) / det;
    return u >= 0 && v >= 0 && u + v <= 1 && distance > 0 ? distance
                                                          : std::numeric_limits<double>::infinity();
}

double closest_by_trying_all(const SceneData& scene, const Ray& ray) {
    double least = std::numeric_limits<double>::infinity();
    for (const Instance& instance : scene.instances)
        for (const Triangle& triangle : scene.meshes[0].triangles) {
            const auto corner = [&](std::size_t i) {
                return instance.world_from_object.point(scene.meshes[0].positions[triangle.vertex[i]]);
            };
            least = std::min(least, distance_to(ray, corner(0), corner(1), corner(2)));
        }
    return least;
}

OpacityFunction never_asked() {
    return [](const Hit&) -> float { throw std::logic_error("opaque surfaces are not asked"); };
}

TEST(Tracer, FindsWhatTryingEveryTriangleFinds) {
    for (const int instances : {1, 3}) {
        const SceneData scene = soup(300, instances);
        const Tracer tracer(scene, never_asked());
        int hits = 0;
        for (std::uint32_t i = 0; i < 2000; ++i) {
            const Ray ray = random_ray(i);
            const Hit hit = tracer.closest_hit(ray);
            const double expected = closest_by_trying_all(scene, ray);
            ASSERT_EQ(static_cast<bool>(hit), std::isfinite(expected)) << i;
            EXPECT_EQ(tracer.occluded(ray), static_cast<bool>(hit));
            if (!hit) continue;
            ++hits;
            EXPECT_NEAR(hit.t, expected, 1e-4);
            EXPECT_LT(hit.instance, scene.instances.size());
        }
        EXPECT_GT(hits, 300);
    }
}

TEST(Tracer, PacketsAgreeWithSingleRays) {
    const SceneData scene = soup(300, 2);
    const Tracer tracer(scene, never_asked());
    for (std::uint32_t packet = 0; packet < 100; ++packet) {
        std::array<Ray, packet_size> rays;
        for (std::uint32_t lane = 0; lane < packet_size; ++lane)
            rays[lane] = random_ray(static_cast<std::uint32_t>(packet_size) * packet + lane);
        rays[3].t_max = -1;  // left out
        std::array<Hit, packet_size> hits;
        std::array<bool, packet_size> blocked{};
        tracer.closest_hits(rays, hits, Coherence::incoherent);
        tracer.occluded(rays, blocked);
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            const Hit alone = lane == 3 ? Hit{} : tracer.closest_hit(rays[lane]);
            EXPECT_EQ(hits[lane].instance, alone.instance);
            EXPECT_EQ(blocked[lane], static_cast<bool>(alone));
            if (alone) {
                EXPECT_NEAR(hits[lane].t, alone.t, 1e-4f);
            }
        }
    }
}

TEST(Tracer, ShadowRaysEndAtTheirTarget) {
    const SceneData scene = soup(300, 1);
    const Tracer tracer(scene, never_asked());
    for (std::uint32_t i = 0; i < 500; ++i) {
        Ray ray = random_ray(i);
        const Hit hit = tracer.closest_hit(ray);
        if (!hit) continue;
        ray.t_max = 0.999f * hit.t;
        EXPECT_FALSE(tracer.occluded(ray));
        ray.t_max = 1.001f * hit.t;
        EXPECT_TRUE(tracer.occluded(ray));
    }
}

TEST(Tracer, BlendedSurfacesAreThereWithTheProbabilityOfTheirOpacity) {
    for (const int instances : {1, 2}) {
        SceneData scene = soup(1, instances, AlphaMode::blend);
        const Tracer tracer(scene, [](const Hit& hit) { return hit.triangle == 0 ? 0.3f : 1.0f; });
        const auto& p = scene.meshes[0].positions;
        const Vec3 target = (p[0] + p[1] + p[2]) / 3, origin{0.1f, 0.2f, 5};
        Ray ray{origin, {normalize(target - origin)}};
        int met = 0, blocked = 0;
        constexpr int rays = 20'000;
        for (std::uint32_t seed = 0; seed < rays; ++seed) {
            ray.opacity_seed = static_cast<std::uint32_t>(mix(seed));
            met += tracer.closest_hit(ray) ? 1 : 0;
            blocked += tracer.occluded(ray) ? 1 : 0;
        }
        EXPECT_NEAR(met, 0.3 * rays, 5 * std::sqrt(0.3 * 0.7 * rays));
        EXPECT_EQ(met, blocked);  // the same seed sees the same surfaces
    }
}

}  // namespace
}  // namespace relumine
