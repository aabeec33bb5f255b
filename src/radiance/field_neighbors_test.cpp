// SPDX-License-Identifier: Apache-2.0
// Smoothing: noise goes, even light stays, and nothing crosses an edge.
#include "radiance/field_neighbors.hpp"

#include <gtest/gtest.h>

namespace relumine {
namespace {

constexpr int side = 9;  // elements along the floor and the wall beside it
constexpr Vec3 up{0, 1, 0}, sideways{1, 0, 0};

/// A floor, and a wall along its left border; nothing in the way.
class Corner : public ::testing::Test {
  protected:
    Corner() {
        CellScale scale;
        scale.size = 0.1f;
        scale.core.add({0, 0, 0});
        scale.core.add({1, 1, 1});
        cells = FieldCells(scale);
        for (int i = 0; i < side; ++i)
            for (int j = 0; j < side; ++j) {
                const float a = (static_cast<float>(i) + 0.5f) * 0.1f;
                const float b = (static_cast<float>(j) + 0.5f) * 0.1f;
                floor.push_back(cells.find_or_make_fine({a, 0.01f, b}, up, 0));
                wall.push_back(cells.find_or_make_fine({0.01f, a, b}, sideways, 0));
            }
        noisy.smoothness.assign(cells.elements().size(), 1);
        noisy.light.resize(cells.elements().size());
    }

    void give(ElementId id, float light) {
        FieldElement& e = cells.elements()[id];
        noisy.light[id].add(e.normal, Spectrum{light});
        e.irradiance.add(e.normal, Spectrum{light + 5});  // 5 is known for certain
    }
    void smooth() {
        RayCounts rays;
        FieldNeighbors(transport, cells, 1, rays).smooth(noisy, 1, cells);
    }
    [[nodiscard]] float light_of(ElementId id) const {
        const FieldElement& e = cells.elements()[id];
        return e.irradiance.towards(e.normal).g - 5;
    }

    SceneData scene;
    Tracer tracer{scene, {}};
    LightSampler lights{scene, {}};
    UniformBsdfs bsdfs{scene, Masking::correlated};
    Transport transport{scene, tracer, lights, bsdfs};
    FieldCells cells{CellScale{}};
    std::vector<ElementId> floor, wall;
    NoisyLight noisy;
};
using FieldSmoothing = Corner;

TEST_F(FieldSmoothing, EvenLightStaysAndDoesNotCrossAnEdge) {
    for (const ElementId id : floor) give(id, 3);
    for (const ElementId id : wall) give(id, 1);
    smooth();
    for (const ElementId id : floor) EXPECT_NEAR(light_of(id), 3, 1e-4f);
    for (const ElementId id : wall) EXPECT_NEAR(light_of(id), 1, 1e-4f);
}

TEST_F(FieldSmoothing, NoiseGoesWhereItMay) {
    const auto noise_of = [&](std::size_t i) { return i % 2 == 0 ? 1.0f : -1.0f; };  // a chessboard
    for (std::size_t i = 0; i < floor.size(); ++i) give(floor[i], 2 + noise_of(i));
    const ElementId held = floor[4 * side + 4];
    noisy.smoothness[held] = 0;
    smooth();
    for (std::size_t i = 0; i < floor.size(); ++i) {
        if (floor[i] == held)
            EXPECT_NEAR(light_of(held), 2 + noise_of(i), 1e-4f);
        else
            EXPECT_NEAR(light_of(floor[i]), 2, 0.5f) << i;
    }
}

}  // namespace
}  // namespace relumine
