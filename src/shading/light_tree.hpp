// SPDX-License-Identifier: Apache-2.0
// A tree over many lights, from whose root a random walk finds one that matters where it is asked.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shading/light_bounds.hpp"

namespace relumine {

/// Eight children of a node side by side, or fewer: the others have no intensity.
inline constexpr std::size_t light_group_size = 8;
struct LightGroup {
    template <typename T>
    using Eight = std::array<T, light_group_size>;

    alignas(32) Eight<float> center_x{}, center_y{}, center_z{}, radius{}, axis_x{}, axis_y{}, axis_z{},
        cos_normals{}, sin_normals{}, cos_spread{}, intensity{};
    Eight<std::int32_t> two_sided{};  // −1 or 0
    Eight<std::uint32_t> next{};      // a light, or the group of the child's children
    Eight<bool> is_light{};

    void set(std::size_t child, const LightCluster& cluster);
};

/// importance() of the eight clusters, with the same bits.
void importances(const LightGroup& group, Vec3 from, LightGroup::Eight<float>& values);

/// A tree over lights with up to eight children per node, three levels of a binary one that was built by the
/// surface area orientation heuristic; a walk goes to a child in proportion to its importance [Conty18].
/// Built alike on every machine; immutable.
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
        return groups_.size() * sizeof(LightGroup) + paths_.size() * sizeof(std::uint64_t);
    }

  private:
    class Builder;
    /// What the next child on a light's path is: three bits a level.
    [[nodiscard]] static std::size_t step(std::uint64_t path) { return path % light_group_size; }

    std::vector<LightGroup> groups_;    // the root's first
    std::vector<std::uint64_t> paths_;  // per light: the steps from the root, lowest bits first
};

}  // namespace relumine
