// SPDX-License-Identifier: Apache-2.0
// pbrt's textures: evaluating graphs of nodes into images, and coordinates from positions.
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

PbrtBaked PbrtTextures::bake(const std::vector<PbrtNodeRef>& nodes, const PbrtCombine& combine, bool srgb,
                             bool plain, const std::array<Vec2, 2>& domain, const PbrtPlace& place) {
    std::vector<const PbrtNode*> leaves;
    for (const PbrtNodeRef& node : nodes) collect_leaves(node, leaves);
    PbrtBaked baked;
    if (leaves.empty()) {
        baked.value = combined(nodes, combine, {});
        return baked;
    }
    const PbrtNode& leaf = *leaves[0];
    Grid grid = choose_grid(leaves, domain, place);
    baked.mapping = leaf.mapping;
    baked.by_domain = grid.by_domain;
    const bool as_it_is = plain && srgb && nodes[0].get() == grid.leaf && leaf.pixels && leaf.pixels->srgb8
                          && !leaf.invert && leaf.factor == 1;
    if (as_it_is) {
        const auto known = shared_images_.find(leaf.pixels->srgb8.get());
        grid.ref.image =
            known != shared_images_.end() ? known->second : add_image(*leaf.pixels->srgb8, place);
        shared_images_[leaf.pixels->srgb8.get()] = grid.ref.image;
        baked.texture = grid.ref;
        return baked;
    }
    ByteImage image = blank(grid.width, grid.height);
    const bool cells = leaf.kind == PbrtNode::Kind::checkerboard;  // row 0 is the upper one
    for (int y = 0; y < grid.height; ++y) {
        for (int x = 0; x < grid.width; ++x) {
            const float s = (static_cast<float>(x) + 0.5f) / static_cast<float>(grid.width);
            const float t = 1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(grid.height);
            const Vec2 base{grid.base_low.x + s * grid.base_size.x, grid.base_low.y + t * grid.base_size.y};
            const At at{base, grid.leaf, x, cells ? grid.height - 1 - y : y};
            put(image, x, y, combined(nodes, combine, at), srgb);
        }
    }
    grid.ref.image = add_image(std::move(image), place);
    baked.texture = grid.ref;
    return baked;
}

namespace {

Vec2 mapped(const PbrtMapping& m, const std::array<double, 3>& p) {
    const auto f = [](double x) { return static_cast<float>(x); };
    if (m.kind == PbrtMapping::Kind::planar)
        return {f(m.offset[0] + p[0] * m.axis_u[0] + p[1] * m.axis_u[1] + p[2] * m.axis_u[2]),
                f(m.offset[1] + p[0] * m.axis_v[0] + p[1] * m.axis_v[1] + p[2] * m.axis_v[2])};
    if (m.kind == PbrtMapping::Kind::cylindrical)
        return {f((pi_d + std::atan2(p[1], p[0])) / (2 * pi_d)), f(p[2])};
    const double length = std::hypot(p[0], p[1], p[2]);
    const double theta = length > 0 ? std::acos(std::clamp(p[2] / length, -1.0, 1.0)) : 0;
    const double phi = std::atan2(p[1], p[0]);
    return {f(theta / pi_d), f((phi < 0 ? phi + 2 * pi_d : phi) / (2 * pi_d))};
}

template <typename T>
void split_attribute(std::vector<T>& values, const std::vector<Triangle>& triangles) {
    if (values.empty()) return;
    std::vector<T> split;
    split.reserve(3 * triangles.size());
    for (const Triangle& t : triangles)
        for (const std::uint32_t vertex : t.vertex) split.push_back(values[vertex]);
    values = std::move(split);
}

void split_vertices(Mesh& mesh) {
    split_attribute(mesh.positions, mesh.triangles);
    split_attribute(mesh.normals, mesh.triangles);
    split_attribute(mesh.uvs[0], mesh.triangles);
    split_attribute(mesh.uvs[1], mesh.triangles);
    std::uint32_t next = 0;
    for (Triangle& t : mesh.triangles)
        for (std::uint32_t& vertex : t.vertex) vertex = next++;
}

}  // namespace

void add_mapped_uvs(Mesh& mesh, const PbrtMapping& mapping, const Transform& world_from_object) {
    const bool wraps = mapping.kind != PbrtMapping::Kind::planar;
    if (wraps) split_vertices(mesh);
    const Transform texture_from_object = mapping.texture_from_world * world_from_object;
    std::vector<Vec2>& uvs = mesh.uvs[1];
    uvs.clear();
    for (const Vec3 p : mesh.positions) {
        std::array<double, 3> q{};
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& r = texture_from_object.m[i];
            q[i] = r[0] * double{p.x} + r[1] * double{p.y} + r[2] * double{p.z} + r[3];
        }
        uvs.push_back(mapped(mapping, q));
    }
    const bool spherical = mapping.kind == PbrtMapping::Kind::spherical;
    if (wraps) {
        for (const Triangle& t :
             mesh.triangles) {  // the angle of a triangle's corners must not jump by a turn
            const auto angle = [&](std::uint32_t v) -> float& { return spherical ? uvs[v].y : uvs[v].x; };
            const float top = std::max({angle(t.vertex[0]), angle(t.vertex[1]), angle(t.vertex[2])});
            for (const std::uint32_t vertex : t.vertex)
                if (top - angle(vertex) > 0.5f) angle(vertex) += 1;
        }
    }
    for (Vec2& uv : uvs) uv.y = 1 - uv.y;
}

}  // namespace relumine
