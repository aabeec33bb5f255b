// SPDX-License-Identifier: Apache-2.0
// Where photons begin: points on the specular surfaces of a scene.
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene_data.hpp"

namespace relumine {

/// Specular triangles. Objects are drawn by the square root of their areas, so that small ones get their
/// share.
class PhotonTargets {
  public:
    struct Target {
        std::uint32_t instance, triangle;
        float area;  // metres²
    };

    explicit PhotonTargets(const SceneData& scene);

    [[nodiscard]] bool empty() const { return targets_.empty(); }
    [[nodiscard]] std::size_t size() const { return targets_.size(); }
    [[nodiscard]] std::size_t draw(float u) const;
    [[nodiscard]] const Target& operator[](std::size_t i) const { return targets_[i]; }
    /// Of the points of a target, 1/metres².
    [[nodiscard]] float density(std::size_t i) const;

  private:
    void add(const SceneData& scene, std::uint32_t instance, float strength, double& sum);

    std::vector<Target> targets_;
    std::vector<double> sums_;  // of their weights, up to and including each
};

}  // namespace relumine
