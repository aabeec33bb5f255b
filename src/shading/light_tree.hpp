// SPDX-License-Identifier: Apache-2.0
// A tree over many lights, from whose root a random walk finds one that matters where it is asked.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shading/light_bounds.hpp"

namespace relumine {

/// A binary tree over lights, built by the surface area orientation heuristic; a walk goes to either child in
/// proportion to its importance [Conty18]. Built alike on every machine; immutable.
class LightTree {
  public:
    /// Lights without intensity are never drawn. There is at least one with.
    explicit LightTree(std::span<const LightBounds> lights);

    struct Choice {
        std::uint32_t light;
        float probability;
        float u;  // in [0, 1): what choosing has left of it
    };
    /// Draws a light for `from`; empty where none can shine there.
    [[nodiscard]] std::optional<Choice> sample(Vec3 from, float u) const;

    /// The probability with which `sample` draws `light`.
    [[nodiscard]] float probability(Vec3 from, std::uint32_t light) const;

    [[nodiscard]] std::size_t bytes() const {
        return nodes_.size() * sizeof(Node) + paths_.size() * sizeof(std::uint64_t);
    }

  private:
    struct Node {
        LightCluster cluster;
        std::uint32_t next = 0;  // the second child (the first follows at once), or the light of a leaf
        bool leaf = false;
    };
    class Builder;

    /// The probability of the first child of an inner node; < 0 where neither shines on `from`.
    [[nodiscard]] float first_share(const Node& first, const Node& second, Vec3 from) const;

    std::vector<Node> nodes_;  // root first, then depth first
    std::vector<std::uint64_t>
        paths_;  // per light: bit i is 1 where the walk takes the second child at level i
};

}  // namespace relumine
