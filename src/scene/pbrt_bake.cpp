// SPDX-License-Identifier: Apache-2.0
// pbrt's textures: evaluating graphs of nodes into images.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "image/srgb.hpp"
#include "scene/pbrt_textures.hpp"

namespace relumine {
namespace {

constexpr std::size_t max_baked_texels = std::size_t{1} << 29;  // 4 GiB
constexpr double pi_d = 3.14159265358979323846;

/// Where a graph is evaluated: at coordinates, or at one texel of its only leaf.
struct At {
    Vec2 base;                       // u, v upwards, before the leaf's own scale
    const PbrtNode* leaf = nullptr;  // read at texel (x, y), or cell of that parity
    int x = 0, y = 0;
    bool facing = true;  // mixes by direction show their first input, else their second
};

Vec2 map_uv(const PbrtMapping& m, Vec2 base) {
    if (m.kind != PbrtMapping::Kind::uv) return base;
    return {static_cast<float>(m.uv[0] * base.x + m.uv[2]), static_cast<float>(m.uv[1] * base.y + m.uv[3])};
}

Spectrum texel(const PbrtNode& node, int x, int y) {
    const PbrtPixels& image = *node.pixels;
    const auto wrap = [&](int i, int size) {
        return node.wrap == Wrap::clamp ? std::clamp(i, 0, size - 1) : (i % size + size) % size;
    };
    const Spectrum raw =
        image.rgb[static_cast<std::size_t>(wrap(y, image.height)) * static_cast<std::size_t>(image.width)
                  + static_cast<std::size_t>(wrap(x, image.width))];
    const auto channel = [&](float c) {
        c *= node.factor;
        return std::max(0.0f, node.invert ? 1 - c : c);
    };
    return {channel(raw.r), channel(raw.g), channel(raw.b)};
}

Spectrum read_image_node(const PbrtNode& node, Vec2 st) {
    const auto tame = [](float c) { return std::isfinite(c) ? std::clamp(c, -1e4f, 1e4f) : 0.0f; };
    const float x = tame(st.x) * static_cast<float>(node.pixels->width);
    const float y = tame(1 - st.y) * static_cast<float>(node.pixels->height);
    if (node.nearest) return texel(node, static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const int i = static_cast<int>(left), j = static_cast<int>(top);
    const float s = x - 0.5f - left, t = y - 0.5f - top;
    return lerp(lerp(texel(node, i, j), texel(node, i + 1, j), s),
                lerp(texel(node, i, j + 1), texel(node, i + 1, j + 1), s), t);
}

bool first_cell(const PbrtNode& node, const At& at) {
    if (at.leaf == &node) return at.x == at.y;
    const Vec2 st = map_uv(node.mapping, at.base);
    return std::fmod(std::floor(double{st.x}) + std::floor(double{st.y}), 2.0) == 0;
}

Spectrum evaluate(const PbrtNode& node, const At& at) {
    switch (node.kind) {
        case PbrtNode::Kind::constant:
            return node.value;
        case PbrtNode::Kind::image:
            return at.leaf == &node ? texel(node, at.x, at.y)
                                    : read_image_node(node, map_uv(node.mapping, at.base));
        case PbrtNode::Kind::checkerboard:
            return evaluate(*node.input[first_cell(node, at) ? 0 : 1], at);
        case PbrtNode::Kind::direction_mix:
            return evaluate(*node.input[at.facing ? 0 : 1], at);
        case PbrtNode::Kind::scale:
            return evaluate(*node.input[0], at) * evaluate(*node.input[1], at);
        case PbrtNode::Kind::mix:
            return lerp(evaluate(*node.input[0], at), evaluate(*node.input[1], at),
                        evaluate(*node.input[2], at).r);
        case PbrtNode::Kind::bilerp: {
            const Vec2 st = map_uv(node.mapping, at.base);
            return lerp(lerp(node.corner[0], node.corner[2], st.x),
                        lerp(node.corner[1], node.corner[3], st.x), st.y);
        }
    }
    return {};
}

Vec4 combined(const std::vector<PbrtNodeRef>& nodes, const PbrtCombine& combine, const At& at) {
    std::vector<Spectrum> values;
    for (const PbrtNodeRef& node : nodes) values.push_back(evaluate(*node, at));
    return combine(values);
}

std::uint16_t encode(float x, bool srgb) {
    const double c = std::clamp(double{x}, 0.0, 1.0);
    return static_cast<std::uint16_t>(std::lround((srgb ? srgb_from_linear(c) : c) * 65535));
}

void put(ByteImage& image, int x, int y, Vec4 c, bool srgb) {
    const std::size_t i =
        4
        * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    image.rgba16[i] = encode(c.x, srgb);
    image.rgba16[i + 1] = encode(c.y, srgb);
    image.rgba16[i + 2] = encode(c.z, srgb);
    image.rgba16[i + 3] = encode(c.w, false);
}

ByteImage blank(int width, int height) {
    return {
        width,
        height,
        {},
        std::vector<std::uint16_t>(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height))};
}

/// Our coordinates (u, 1 − v) to those of a leaf's image, v downwards; `scale`: periods per image.
std::array<float, 6> leaf_transform(const PbrtMapping& m, float scale) {
    if (m.kind != PbrtMapping::Kind::uv) return {scale, 0, 0, 0, scale, 1 - scale};
    const auto f = [](double x) { return static_cast<float>(x); };
    const float su = f(m.uv[0]) * scale, sv = f(m.uv[1]) * scale;
    return {su, 0, f(m.uv[2]) * scale, 0, sv, 1 - sv - f(m.uv[3]) * scale};
}

/// How many texels a leaf has over one unit of u and of v.
std::array<double, 2> density(const PbrtNode& leaf) {
    const double su = leaf.mapping.kind == PbrtMapping::Kind::uv ? std::abs(leaf.mapping.uv[0]) : 1;
    const double sv = leaf.mapping.kind == PbrtMapping::Kind::uv ? std::abs(leaf.mapping.uv[1]) : 1;
    if (leaf.kind == PbrtNode::Kind::image) return {su * leaf.pixels->width, sv * leaf.pixels->height};
    const double pieces = leaf.kind == PbrtNode::Kind::checkerboard ? 64 : 256;
    return {su * pieces, sv * pieces};
}

bool same_grid(const PbrtNode& a, const PbrtNode& b) {
    return a.kind == b.kind && a.kind == PbrtNode::Kind::image && a.mapping == b.mapping && a.wrap == b.wrap
           && a.nearest == b.nearest && a.pixels->width == b.pixels->width
           && a.pixels->height == b.pixels->height;
}

}  // namespace

ImageId PbrtTextures::add_image(ByteImage image, const PbrtPlace& place) {
    baked_texels_ += static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (baked_texels_ > max_baked_texels)
        refuse_pbrt(place, fmt::format("at most {} texels in all textures", max_baked_texels), "more");
    out_.images.push_back(std::move(image));
    return static_cast<ImageId>(out_.images.size() - 1);
}

/// The texels of a baked image, and where each is evaluated.
struct PbrtTextures::Grid {
    TextureRef ref;
    int width = 1, height = 1;
    const PbrtNode* leaf = nullptr;  // the only one, which each texel stands for
    Vec2 base_low, base_size;        // else: u and v (upwards) of the lower left corner, and of the whole
    bool by_domain = false;
};

/// The grid of a single leaf, or of images that have the same one; else one that is fine enough for all.
PbrtTextures::Grid PbrtTextures::choose_grid(const std::vector<const PbrtNode*>& leaves,
                                             const std::array<Vec2, 2>& domain, const PbrtPlace& place) {
    constexpr int max_side = 4096;
    const PbrtNode& leaf = *leaves[0];
    const bool single = leaves.size() == 1, by_uv = leaf.mapping.kind == PbrtMapping::Kind::uv;
    Grid grid;
    grid.ref.uv_set = by_uv ? 0 : 1;
    if (single && leaf.kind == PbrtNode::Kind::checkerboard) {
        grid.leaf = &leaf;
        grid.width = grid.height = 2;
        grid.ref.uv_transform = leaf_transform(leaf.mapping, 0.5f);
        grid.ref.nearest = true;
        return grid;
    }
    const bool same = leaf.kind == PbrtNode::Kind::image && leaf.mapping.uv[0] != 0 && leaf.mapping.uv[1] != 0
                      && (single || by_uv) && std::ranges::all_of(leaves, [&](const PbrtNode* other) {
                             return other == &leaf || same_grid(*other, leaf);
                         });
    if (same) {
        const auto& m = leaf.mapping.uv;  // the base at which all of them read the whole picture
        const auto f = [](double x) { return static_cast<float>(x); };
        grid.leaf = single ? &leaf : nullptr;
        grid.width = leaf.pixels->width;
        grid.height = leaf.pixels->height;
        grid.ref.uv_transform = leaf_transform(leaf.mapping, 1);
        grid.ref.wrap_u = grid.ref.wrap_v = leaf.wrap;
        grid.ref.nearest = leaf.nearest;
        grid.base_low = {f(-m[2] / m[0]), f(-m[3] / m[1])};
        grid.base_size = {f(1 / m[0]), f(1 / m[1])};
        return grid;
    }
    const Vec2 low = by_uv ? domain[0] : Vec2{0, 0}, high = by_uv ? domain[1] : Vec2{1, 1};
    const Vec2 size{std::max(high.x - low.x, 1e-6f), std::max(high.y - low.y, 1e-6f)};
    double columns = 1, rows = 1;
    for (const PbrtNode* other : leaves) {
        const auto [du, dv] = density(*other);
        columns = std::max(columns, du * double{size.x});
        rows = std::max(rows, dv * double{size.y});
        if (other->mapping.kind != leaf.mapping.kind)
            scene_.warn(place, "textures of different mappings in one material are read with the first's");
    }
    if (columns > max_side || rows > max_side)
        scene_.warn(place, fmt::format("textures are combined at {0} × {0} texels", max_side));
    grid.width = static_cast<int>(std::clamp(columns, 1.0, double{max_side}));
    grid.height = static_cast<int>(std::clamp(rows, 1.0, double{max_side}));
    grid.by_domain = by_uv;
    grid.ref.uv_transform = {1 / size.x, 0, -low.x / size.x, 0, 1 / size.y, -(1 - high.y) / size.y};
    grid.ref.wrap_u = grid.ref.wrap_v = Wrap::clamp;
    grid.base_low = low;
    grid.base_size = size;
    return grid;
}

/// The axis that mixes by direction ask for.
Vec3 PbrtTextures::find_axis(const std::vector<PbrtNodeRef>& nodes, const PbrtPlace& place) {
    std::vector<const PbrtNode*> mixes;
    for (const PbrtNodeRef& node : nodes) collect_direction_mixes(node, mixes);
    for (const PbrtNode* mix : mixes)
        if (!(mix->axis == mixes[0]->axis))
            scene_.warn(place, "one material mixes by several directions: the first of them stands for all");
    return mixes.empty() ? Vec3{} : mixes[0]->axis;
}

ByteImage PbrtTextures::baked_image(const Grid& grid, const std::vector<PbrtNodeRef>& nodes,
                                    const PbrtCombine& combine, bool srgb, bool facing) const {
    ByteImage image = blank(grid.width, grid.height);
    const bool cells =
        grid.leaf && grid.leaf->kind == PbrtNode::Kind::checkerboard;  // row 0 is the upper one
    for (int y = 0; y < grid.height; ++y) {
        for (int x = 0; x < grid.width; ++x) {
            const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(grid.width);
            const float t = 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(grid.height);
            const Vec2 base{grid.base_low.x + s * grid.base_size.x, grid.base_low.y + t * grid.base_size.y};
            const At at{base, grid.leaf, x, cells ? grid.height - 1 - y : y, facing};
            put(image, x, y, combined(nodes, combine, at), srgb);
        }
    }
    return image;
}

PbrtBaked PbrtTextures::bake(const std::vector<PbrtNodeRef>& nodes, const PbrtCombine& combine, bool srgb,
                             bool plain, const std::array<Vec2, 2>& domain, const PbrtPlace& place) {
    std::vector<const PbrtNode*> leaves;
    for (const PbrtNodeRef& node : nodes) collect_leaves(node, leaves);
    PbrtBaked baked;
    baked.axis = find_axis(nodes, place);
    const bool by_direction = length_squared(baked.axis) > 0;
    if (leaves.empty() && !by_direction) {
        baked.value = combined(nodes, combine, {});
        return baked;
    }
    Grid grid = leaves.empty() ? Grid{} : choose_grid(leaves, domain, place);
    if (!leaves.empty()) baked.mapping = leaves[0]->mapping;
    baked.by_domain = grid.by_domain;
    const PbrtNode* leaf = grid.leaf;
    const bool as_it_is = plain && srgb && leaf && nodes[0].get() == leaf && leaf->pixels
                          && leaf->pixels->srgb8 && !leaf->invert && leaf->factor == 1;
    if (as_it_is) {
        const auto known = shared_images_.find(leaf->pixels->srgb8.get());
        grid.ref.image =
            known != shared_images_.end() ? known->second : add_image(*leaf->pixels->srgb8, place);
        shared_images_[leaf->pixels->srgb8.get()] = grid.ref.image;
        baked.texture = grid.ref;
        return baked;
    }
    grid.ref.image = add_image(baked_image(grid, nodes, combine, srgb, true), place);
    if (by_direction) grid.ref.turned_away = add_image(baked_image(grid, nodes, combine, srgb, false), place);
    baked.texture = grid.ref;
    return baked;
}

std::shared_ptr<const TextureProjection> make_projection(const PbrtMapping& mapping, Vec3 axis, bool smooth) {
    using Kind = PbrtMapping::Kind;
    if (mapping.kind == Kind::uv && length_squared(axis) == 0) return {};
    TextureProjection projection{TextureProjection::Kind::none, mapping.texture_from_world, axis, smooth};
    if (mapping.kind == Kind::spherical) projection.kind = TextureProjection::Kind::spherical;
    if (mapping.kind == Kind::cylindrical) projection.kind = TextureProjection::Kind::cylindrical;
    if (mapping.kind == Kind::planar) {
        projection.kind = TextureProjection::Kind::planar;
        Transform st_from_texture;
        for (std::size_t j = 0; j < 3; ++j) {
            st_from_texture.m[0][j] = mapping.axis_u[j];
            st_from_texture.m[1][j] = mapping.axis_v[j];
        }
        st_from_texture.m[0][3] = mapping.offset[0];
        st_from_texture.m[1][3] = mapping.offset[1];
        projection.texture_from_world = st_from_texture * mapping.texture_from_world;
    }
    return std::make_shared<const TextureProjection>(projection);
}

}  // namespace relumine
