// SPDX-License-Identifier: Apache-2.0
// Greedy merging: a texel grows to the right while it may, then down row by row.
#include "cache/surfel_merge.hpp"

#include <half.h>

#include <algorithm>

#include "base/rgbe.hpp"
#include "cache/hemisphere_map.hpp"

namespace relumine {
namespace {

constexpr std::uint8_t taken = 0xff;  // instead of a layer: the texel belongs to a surfel already

/// Corners may lie this much nearer or farther than the texel beside them: planes seen edge-on end somewhere.
constexpr float nearest_corner = 0.7f, farthest_corner = 1.4f;

std::uint16_t half_bits(float x) { return half(x).bits(); }

class Merger {
  public:
    Merger(const std::vector<TexelSample>& texels, const DepthLayers& layers, const GatherPoint& point,
           int side, const MergeLimits& limits)
        : texels_(texels),
          layers_(layers),
          point_(point),
          side_(side),
          limits_(limits),
          layer_(layers.layer_of_texel) {
        const float texel_angle = std::sqrt(hemisphere_solid_angle) / static_cast<float>(side);
        deviation_ = limits.reuse_distance > 0 ? texel_angle / (4 * limits.reuse_distance) : infinity;
    }

    Surfels merge() {
        std::vector<std::vector<TexelRect>> by_layer(static_cast<std::size_t>(layers_.count) + 1);
        for (int v = 0; v < side_; ++v)
            for (int u = 0; u < side_; ++u)
                if (const std::uint8_t layer = layer_[at(u, v)]; layer != taken && layer != layers_.count)
                    by_layer[layer].push_back(grow(u, v));
        by_layer.back() = tiles_at_infinity();
        return pack(by_layer);
    }

  private:
    [[nodiscard]] std::size_t at(int u, int v) const { return static_cast<std::size_t>(v * side_ + u); }

    /// Few squares instead of many fragments: `missed` says which texels of theirs are drawn.
    [[nodiscard]] std::vector<TexelRect> tiles_at_infinity() const {
        std::vector<TexelRect> tiles;
        for (int v = 0; v < side_; v += limits_.side)
            for (int u = 0; u < side_; u += limits_.side)
                if (const TexelRect tile = missed_part(u, v); tile.width > 0) tiles.push_back(tile);
        return tiles;
    }

    /// The smallest rectangle around what was missed of a square of texels; empty where nothing was.
    [[nodiscard]] TexelRect missed_part(int u, int v) const {
        int u0 = side_, u1 = 0, v0 = side_, v1 = 0;
        for (int y = v; y < std::min(v + limits_.side, side_); ++y)
            for (int x = u; x < std::min(u + limits_.side, side_); ++x) {
                if (layers_.layer_of_texel[at(x, y)] != layers_.count) continue;
                u0 = std::min(u0, x), u1 = std::max(u1, x + 1);
                v0 = std::min(v0, y), v1 = std::max(v1, y + 1);
            }
        return u1 > 0 ? rect(u0, v0, u1 - u0, v1 - v0) : TexelRect{};
    }

    [[nodiscard]] static TexelRect rect(int u, int v, int width, int height) {
        const auto byte = [](int i) { return static_cast<std::uint8_t>(i); };
        return {byte(u), byte(v), byte(width), byte(height)};
    }

    TexelRect grow(int u, int v) {
        const std::size_t seed = at(u, v);
        int width = 1, height = 1;
        while (width < limits_.side && u + width < side_ && joins(seed, at(u + width, v))) ++width;
        while (height < limits_.side && v + height < side_ && row_joins(seed, u, v + height, width)) ++height;
        for (int y = v; y < v + height; ++y)
            for (int x = u; x < u + width; ++x) layer_[at(x, y)] = taken;
        return rect(u, v, width, height);
    }

    [[nodiscard]] bool row_joins(std::size_t seed, int u, int v, int width) const {
        for (int x = u; x < u + width; ++x)
            if (!joins(seed, at(x, v))) return false;
        return true;
    }

    [[nodiscard]] bool joins(std::size_t seed, std::size_t other) const {
        const TexelSample &a = texels_[seed], &b = texels_[other];
        if (layer_[other] != layers_.layer_of_texel[seed]) return false;
        return dot(a.normal, b.normal) >= limits_.cos_normals
               && std::abs(dot(a.normal, b.offset - a.offset)) <= deviation_ * sqr(b.distance);
    }

    [[nodiscard]] Surfels pack(std::vector<std::vector<TexelRect>>& by_layer) const {
        Surfels out;
        out.scale =
            layers_.farthest > 0 ? layers_.farthest / 1024 : 1;  // well inside the range of half floats
        for (auto& layer : by_layer) {
            const auto black =
                std::ranges::stable_partition(layer, [&](const TexelRect& r) { return !is_black(r); });
            const auto begin = static_cast<std::uint32_t>(out.texels.size());
            out.layer_begin.push_back(begin);
            out.black_begin.push_back(begin + static_cast<std::uint32_t>(layer.size() - black.size()));
            out.texels.insert(out.texels.end(), layer.begin(), layer.end());
        }
        out.layer_begin.push_back(static_cast<std::uint32_t>(out.texels.size()));
        out.count = out.stride = out.texels.size();
        out.texels.resize(out.count + surfel_padding);
        out.corners.resize(corner_planes * out.stride + surfel_padding);
        for (std::size_t i = 0; i < out.count; ++i) put_corners(out, i);
        out.missed.resize(texels_.size() / 8);
        for (std::size_t i = 0; i < texels_.size(); ++i)
            if (layers_.layer_of_texel[i] == layers_.count)
                out.missed[i / 8] = static_cast<std::uint8_t>(out.missed[i / 8] | 1u << i % 8);
        return out;
    }

    /// As the texture keeps it.
    [[nodiscard]] bool is_black(const TexelRect& r) const {
        for (int v = r.v; v < r.v + r.height; ++v)
            for (int u = r.u; u < r.u + r.width; ++u)
                if (pack_rgbe(texels_[at(u, v)].radiance) != 0) return false;
        return true;
    }

    void put_corners(Surfels& out, std::size_t i) const {
        const TexelRect& r = out.texels[i];
        const bool at_infinity = i >= out.infinity_begin();
        for (int corner = 0; corner < 4; ++corner) {
            const int right = corner & 1, down = corner >> 1;
            const LocalDir direction = corner_direction(r.u + right * r.width, r.v + down * r.height);
            const TexelSample& seed = texels_[at(r.u, r.v)];
            const TexelSample& beside = texels_[at(r.u + right * (r.width - 1), r.v + down * (r.height - 1))];
            const float reach =
                at_infinity ? 1 : corner_distance(seed, beside, point_.frame.to_world(direction)) / out.scale;
            const Vec3 offset = direction.v * reach;
            for (int axis = 0; axis < 3; ++axis)
                out.corners[static_cast<std::size_t>(3 * corner + axis) * out.stride + i] =
                    half_bits(offset[axis]);
        }
    }

    [[nodiscard]] LocalDir corner_direction(int u, int v) const {
        const auto n = static_cast<float>(side_);
        return square_to_hemisphere({static_cast<float>(u) / n, static_cast<float>(v) / n});
    }

    /// Where the ray through a corner meets the plane of the surfel.
    [[nodiscard]] static float corner_distance(const TexelSample& seed, const TexelSample& beside,
                                               WorldDir direction) {
        const float facing = dot(seed.normal, direction.v);
        const float on_plane = facing < -1e-4f ? dot(seed.normal, seed.offset) / facing : beside.distance;
        return std::clamp(on_plane, nearest_corner * beside.distance, farthest_corner * beside.distance);
    }

    const std::vector<TexelSample>& texels_;
    const DepthLayers& layers_;
    const GatherPoint& point_;
    int side_;
    MergeLimits limits_;
    std::vector<std::uint8_t> layer_;  // of texels that are still free
    float deviation_;                  // from the plane, per squared distance
};

}  // namespace

Surfels merge_surfels(const std::vector<TexelSample>& texels, const DepthLayers& layers,
                      const GatherPoint& point, int side, const MergeLimits& limits) {
    return Merger(texels, layers, point, side, limits).merge();
}

}  // namespace relumine
