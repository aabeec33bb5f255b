// SPDX-License-Identifier: Apache-2.0
// Building light trees and walking them.
#include "shading/light_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "base/assert.hpp"

namespace relumine {
namespace {

constexpr int buckets = 12;
constexpr int levels_per_group = 3;  // of the binary tree: 8 children
constexpr int balanced_depth = 24;   // from here on groups are halved: the depth stays below 64
constexpr std::uint64_t never_drawn = ~std::uint64_t{0};

float coordinate(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

void LightGroup::set(std::size_t child, const LightCluster& c) {
    center_x[child] = c.center.x;
    center_y[child] = c.center.y;
    center_z[child] = c.center.z;
    radius[child] = c.radius;
    axis_x[child] = c.axis.x;
    axis_y[child] = c.axis.y;
    axis_z[child] = c.axis.z;
    cos_normals[child] = c.cos_normals;
    sin_normals[child] = c.sin_normals;
    cos_spread[child] = c.cos_spread;
    intensity[child] = c.intensity;
    two_sided[child] = c.two_sided ? -1 : 0;
}

class LightTree::Builder {
  public:
    Builder(std::span<const LightBounds> lights, LightTree& tree) : lights_(lights), tree_(tree) {
        for (std::uint32_t i = 0; i < lights.size(); ++i)
            if (lights[i].intensity > 0) order_.push_back(i);
        RELUMINE_ASSERT(!order_.empty());
        tree_.paths_.assign(lights.size(), never_drawn);
    }

    void build() { add_group({order_, bounds_of(order_), 0}, 0, 0); }

  private:
    /// A node of the binary tree.
    struct Part {
        std::span<std::uint32_t> lights;
        LightBounds bounds;
        int depth;
    };
    /// Where to split: lights in buckets below `bucket` along `axis` come first.
    struct Split {
        int axis = -1, bucket = 0;
        double cost = std::numeric_limits<double>::infinity();
    };

    [[nodiscard]] LightBounds bounds_of(std::span<const std::uint32_t> lights) const {
        LightBounds bounds;
        for (const std::uint32_t light : lights) bounds = unite(bounds, lights_[light]);
        return bounds;
    }

    /// Appends the group of the part's children, then theirs; returns its index.
    std::uint32_t add_group(const Part& whole, std::uint64_t path, int level) {
        const std::size_t group = tree_.groups_.size();
        tree_.groups_.emplace_back();
        std::vector<Part> parts{whole};
        for (int i = 0; i < levels_per_group; ++i) parts = halves_of(parts);
        for (std::size_t child = 0; child < parts.size(); ++child) {
            const std::uint64_t here = path | std::uint64_t{child} << (levels_per_group * level);
            const bool is_light = parts[child].lights.size() == 1;
            const std::uint32_t light = parts[child].lights.front();
            if (is_light) tree_.paths_[light] = here;
            const std::uint32_t next = is_light ? light : add_group(parts[child], here, level + 1);
            LightGroup& g = tree_.groups_[group];
            g.set(child, LightCluster(parts[child].bounds));
            g.next[child] = next;
            g.is_light[child] = is_light;
        }
        return static_cast<std::uint32_t>(group);
    }

    [[nodiscard]] std::vector<Part> halves_of(std::span<const Part> parts) const {
        std::vector<Part> halves;
        for (const Part& part : parts) {
            if (part.lights.size() == 1) {
                halves.push_back(part);
                continue;
            }
            const std::size_t middle = divide(part.lights, part.bounds, part.depth);
            for (const auto half : {part.lights.first(middle), part.lights.subspan(middle)})
                halves.push_back({half, bounds_of(half), part.depth + 1});
        }
        return halves;
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

std::optional<LightTree::Choice> LightTree::sample(Vec3 from, float u) const {
    float probability = 1;
    for (const LightGroup* group = groups_.data();;) {
        LightGroup::Eight<float> shares;
        importances(*group, from, shares);
        const float total = std::accumulate(shares.begin(), shares.end(), 0.0f);
        if (!(total > 0)) return {};
        float left = u * total;
        std::size_t child = 0, last = 0;
        for (std::size_t i = 0; i < light_group_size; ++i)
            if (shares[i] > 0) last = i;
        while (child < last && !(left < shares[child])) left -= shares[child++];
        u = std::clamp(left / shares[child], 0.0f, 0x1.fffffep-1f);
        probability *= shares[child] / total;
        if (group->is_light[child]) return Choice{group->next[child], probability, u};
        group = &groups_[group->next[child]];
    }
}

float LightTree::probability(Vec3 from, std::uint32_t light) const {
    std::uint64_t path = paths_[light];
    if (path == never_drawn) return 0;
    float probability = 1;
    for (const LightGroup* group = groups_.data();; path >>= levels_per_group) {
        LightGroup::Eight<float> shares;
        importances(*group, from, shares);
        const float total = std::accumulate(shares.begin(), shares.end(), 0.0f);
        const std::size_t child = step(path);
        if (!(total > 0)) return 0;
        probability *= shares[child] / total;
        if (group->is_light[child]) return probability;
        group = &groups_[group->next[child]];
    }
}

}  // namespace relumine
