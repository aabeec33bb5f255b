// SPDX-License-Identifier: Apache-2.0
// Building light trees and walking them.
#include "shading/light_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/assert.hpp"

namespace relumine {
namespace {

constexpr int buckets = 12;
constexpr int balanced_depth = 24;  // from here on groups are halved: the depth stays below 64
constexpr std::uint64_t never_drawn = ~std::uint64_t{0};

float coordinate(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

class LightTree::Builder {
  public:
    Builder(std::span<const LightBounds> lights, LightTree& tree) : lights_(lights), tree_(tree) {
        for (std::uint32_t i = 0; i < lights.size(); ++i)
            if (lights[i].intensity > 0) order_.push_back(i);
        RELUMINE_ASSERT(!order_.empty());
        tree_.nodes_.reserve(2 * order_.size() - 1);
        tree_.paths_.assign(lights.size(), never_drawn);
    }

    void build() { add(order_, 0, 0); }

  private:
    /// Where to split: lights in buckets below `bucket` along `axis` come first.
    struct Split {
        int axis = -1, bucket = 0;
        double cost = std::numeric_limits<double>::infinity();
    };

    void add(std::span<std::uint32_t> lights, std::uint64_t path, int depth) {
        LightBounds bounds;
        for (const std::uint32_t light : lights) bounds = unite(bounds, lights_[light]);
        const std::size_t node = tree_.nodes_.size();
        tree_.nodes_.push_back({LightCluster(bounds), lights.front(), lights.size() == 1});
        if (lights.size() == 1) {
            tree_.paths_[lights.front()] = path;
            return;
        }
        const std::size_t middle = divide(lights, bounds, depth);
        add(lights.first(middle), path, depth + 1);
        tree_.nodes_[node].next = static_cast<std::uint32_t>(tree_.nodes_.size());
        add(lights.subspan(middle), path | std::uint64_t{1} << depth, depth + 1);
    }

    /// Puts the lights in order; returns how many belong to the first child.
    std::size_t divide(std::span<std::uint32_t> lights, const LightBounds& bounds, int depth) const {
        Bounds3 centers;
        for (const std::uint32_t light : lights) centers.add(lights_[light].box.center());
        Split best;
        for (int axis = 0; axis < 3 && depth < balanced_depth; ++axis)
            try_axis(lights, bounds, centers, axis, best);
        if (best.axis < 0) return lights.size() / 2;
        const auto second = std::stable_partition(lights.begin(), lights.end(), [&](std::uint32_t light) {
            return bucket_of(light, centers, best.axis) < best.bucket;
        });
        return static_cast<std::size_t>(second - lights.begin());
    }

    void try_axis(std::span<const std::uint32_t> lights, const LightBounds& bounds, const Bounds3& centers,
                  int axis, Split& best) const {
        const Vec3 size = bounds.box.upper - bounds.box.lower;
        if (!(coordinate(centers.upper, axis) > coordinate(centers.lower, axis))) return;
        std::array<LightBounds, buckets> parts;
        for (const std::uint32_t light : lights) {
            LightBounds& part = parts[static_cast<std::size_t>(bucket_of(light, centers, axis))];
            part = unite(part, lights_[light]);
        }
        std::array<LightBounds, buckets + 1> above;
        for (std::size_t i = buckets; i-- > 0;) above[i] = unite(parts[i], above[i + 1]);
        const double stretch = double{std::max({size.x, size.y, size.z})} / coordinate(size, axis);
        LightBounds below;
        for (std::size_t i = 1; i < buckets; ++i) {
            below = unite(below, parts[i - 1]);
            if (below.intensity <= 0 || above[i].intensity <= 0) continue;
            const double cost = orientation_cost(below, stretch) + orientation_cost(above[i], stretch);
            if (cost < best.cost) best = {axis, static_cast<int>(i), cost};
        }
    }

    [[nodiscard]] int bucket_of(std::uint32_t light, const Bounds3& centers, int axis) const {
        const float low = coordinate(centers.lower, axis), high = coordinate(centers.upper, axis);
        const float place = (coordinate(lights_[light].box.center(), axis) - low) / (high - low);
        return std::clamp(static_cast<int>(place * buckets), 0, buckets - 1);
    }

    std::span<const LightBounds> lights_;
    LightTree& tree_;
    std::vector<std::uint32_t> order_;
};

LightTree::LightTree(std::span<const LightBounds> lights) { Builder(lights, *this).build(); }

float LightTree::first_share(const Node& first, const Node& second, Vec3 from) const {
    const float a = importance(first.cluster, from), b = importance(second.cluster, from);
    return a + b > 0 ? a / (a + b) : -1;
}

std::optional<LightTree::Choice> LightTree::sample(Vec3 from, float u) const {
    float probability = 1;
    for (std::size_t i = 0; !nodes_[i].leaf;) {
        const std::size_t first = i + 1, second = nodes_[i].next;
        const float share = first_share(nodes_[first], nodes_[second], from);
        if (share < 0) return {};
        const bool takes_first = u < share;
        u = takes_first ? u / share : (u - share) / (1 - share);
        u = std::min(u, 0x1.fffffep-1f);
        probability *= takes_first ? share : 1 - share;
        i = takes_first ? first : second;
        if (nodes_[i].leaf) return Choice{nodes_[i].next, probability, u};
    }
    return Choice{nodes_[0].next, 1, u};
}

float LightTree::probability(Vec3 from, std::uint32_t light) const {
    std::uint64_t path = paths_[light];
    if (path == never_drawn) return 0;
    float probability = 1;
    for (std::size_t i = 0; !nodes_[i].leaf; path >>= 1) {
        const std::size_t first = i + 1, second = nodes_[i].next;
        const float share = first_share(nodes_[first], nodes_[second], from);
        if (share < 0) return 0;
        probability *= (path & 1) == 0 ? share : 1 - share;
        i = (path & 1) == 0 ? first : second;
    }
    return probability;
}

}  // namespace relumine
