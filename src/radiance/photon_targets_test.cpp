// SPDX-License-Identifier: Apache-2.0
// Where photons begin: triangles are drawn as often as their densities say.
#include "radiance/photon_targets.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr double false_positive_rate = 1e-6;  // of each χ² below; the numbers are fixed

/// Fans of triangles that grow, of one material each; the last triangle of each fan is degenerate.
void add_fan(SceneData& scene, const Material& material, float size, int triangles) {
    Mesh mesh;
    mesh.material = static_cast<MaterialId>(scene.materials.size());
    scene.materials.push_back(material);
    mesh.positions.push_back({});
    for (int i = 0; i <= triangles; ++i) {
        const float x = size * static_cast<float>(i * i);
        mesh.positions.push_back({x, size, 0});
    }
    mesh.positions.push_back(mesh.positions.back());
    for (int i = 1; i <= triangles + 1; ++i) {
        const auto corner = static_cast<std::uint32_t>(i);
        mesh.triangles.push_back({{0, corner, corner + 1}});
    }
    Instance instance;
    instance.identity = true;
    instance.mesh = static_cast<MeshId>(scene.meshes.size());
    scene.meshes.push_back(mesh);
    scene.instances.push_back(instance);
}

SceneData mirrors_and_others() {
    SceneData scene;
    Material mirror, coat, matte;
    mirror.metallic = 1;
    mirror.roughness = 0;
    coat.metallic = 0;
    coat.roughness = 0.1f;
    matte.roughness = 1;
    add_fan(scene, mirror, 1, 6);
    add_fan(scene, matte, 3, 4);
    add_fan(scene, mirror, 0.1f, 5);
    add_fan(scene, coat, 2, 3);
    return scene;
}

TEST(PhotonTargets, AreSpecularAndHaveAnArea) {
    const PhotonTargets targets(mirrors_and_others());
    EXPECT_EQ(targets.size(), 6u + 5 + 3);
    for (std::size_t i = 0; i < targets.size(); ++i) {
        EXPECT_NE(targets[i].instance, 1u);
        EXPECT_GT(targets[i].area, 0);
    }
}

TEST(PhotonTargets, AreDrawnByTheirDensity) {
    const PhotonTargets targets(mirrors_and_others());
    constexpr int draws = 200'000;
    std::vector<double> expected;
    double total = 0;
    for (std::size_t i = 0; i < targets.size(); ++i) {
        expected.push_back(double{draws} * double{targets.density(i)} * double{targets[i].area});
        total += expected.back();
    }
    EXPECT_NEAR(total, draws, 1e-4 * draws);
    const auto p = [&](float squeezed) {
        std::vector<double> observed(targets.size());
        for (std::uint32_t i = 0; i < draws; ++i)
            ++observed[targets.draw(
                squeezed * SampleStream{13, i, 1, PointSet::independent}.next1(Dim::light_choice))];
        return testing::chi_square_p(observed, expected);
    };
    EXPECT_GT(p(1), false_positive_rate);
    EXPECT_LT(p(0.99f), false_positive_rate);  // 1 % of the numbers left out must be caught
}

}  // namespace
}  // namespace relumine
