// SPDX-License-Identifier: Apache-2.0
// pbrt's textures: graphs of nodes, evaluated into the images that materials read.
#pragma once

#include <functional>
#include <memory>

#include "scene/pbrt_files.hpp"
#include "scene/pbrt_scene.hpp"
#include "scene/pbrt_spectrum.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// From a surface to texture coordinates (s, t), t upwards.
struct PbrtMapping {
    enum class Kind { uv, planar, spherical, cylindrical };
    Kind kind = Kind::uv;
    std::array<double, 4> uv{1, 1, 0, 0};                    // scales and offsets of u and v
    std::array<double, 3> axis_u{1, 0, 0}, axis_v{0, 1, 0};  // planar
    std::array<double, 2> offset{};                          // planar
    Transform texture_from_world;

    bool operator==(const PbrtMapping&) const = default;
};

/// Linear RGB pixels, top row first.
struct PbrtPixels {
    int width = 0, height = 0;
    std::vector<Spectrum> rgb;
    std::vector<float> alpha;                // empty where all of it is 1
    std::shared_ptr<const ByteImage> srgb8;  // the file itself where it is 8-bit sRGB
};

struct PbrtNode;
using PbrtNodeRef = std::shared_ptr<const PbrtNode>;

/// A node of a texture graph.
struct PbrtNode {
    enum class Kind { constant, image, checkerboard, scale, mix, direction_mix, bilerp };
    Kind kind = Kind::constant;
    Spectrum value;                    // constant
    std::array<PbrtNodeRef, 3> input;  // mix: two and the amount; others: two
    Vec3 axis;                       // direction_mix: world space, unit; what faces it shows the first input
    std::array<Spectrum, 4> corner;  // bilerp: v00, v01, v10, v11
    PbrtMapping mapping;
    std::shared_ptr<const PbrtPixels> pixels;
    Wrap wrap = Wrap::repeat;
    bool invert = false, nearest = false;
    float factor = 1;
};

/// What `PbrtTextures::bake` made: one value, or an image.
struct PbrtBaked {
    Vec4 value;  // where there is no texture
    std::optional<TextureRef> texture;
    PbrtMapping mapping;     // where its coordinates come from something else than uv: of uv set 1
    Vec3 axis;               // that surfaces may face; 0: it does not matter
    bool by_domain = false;  // made for one range of u and v alone
};

/// Turns several nodes' values at a point into RGBA in [0, 1].
using PbrtCombine = std::function<Vec4(std::span<const Spectrum>)>;

/// Builds and bakes textures.
class PbrtTextures {
  public:
    PbrtTextures(PbrtScene& scene, PbrtFiles& files, SceneData& out)
        : scene_(scene), files_(files), out_(out) {}

    /// The parameter `name` as spectrum or texture of one; `otherwise` where it is not given.
    [[nodiscard]] PbrtNodeRef spectrum(const PbrtParameters& p, std::string_view name, Spectrum otherwise,
                                       PbrtSpectrumUse use);
    /// Null where it is not given.
    [[nodiscard]] PbrtNodeRef spectrum_or_null(const PbrtParameters& p, std::string_view name,
                                               PbrtSpectrumUse use);
    /// The same of numbers.
    [[nodiscard]] PbrtNodeRef number(const PbrtParameters& p, std::string_view name, double otherwise);
    [[nodiscard]] PbrtNodeRef number_or_null(const PbrtParameters& p, std::string_view name);
    /// A picture file with pbrt's meaning of its 8-bit values. `encoding`: "sRGB", "linear", "gamma <x>".
    [[nodiscard]] std::shared_ptr<const PbrtPixels> pixels(const std::string& file,
                                                           const std::string& encoding,
                                                           const PbrtPlace& place);

    /// An image (or one value) of `combine` over the surface. `domain`: the mesh's range of u and v, for
    /// graphs that read more than one image. `srgb`: how the RGB is stored. `plain`: combine is the identity.
    [[nodiscard]] PbrtBaked bake(const std::vector<PbrtNodeRef>& nodes, const PbrtCombine& combine, bool srgb,
                                 bool plain, const std::array<Vec2, 2>& domain, const PbrtPlace& place);

  private:
    using Textures = std::map<std::string, PbrtTexture>;
    [[nodiscard]] PbrtNodeRef make(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use);
    [[nodiscard]] PbrtNodeRef named(const Textures& textures, const PbrtParameter& reference, bool is_float,
                                    PbrtSpectrumUse use);
    [[nodiscard]] PbrtNodeRef image_node(const PbrtTexture& texture, bool is_float);
    [[nodiscard]] PbrtNodeRef mix_node(const PbrtParameters& p, bool is_float, PbrtSpectrumUse use,
                                       PbrtNodeRef amount);
    [[nodiscard]] PbrtNodeRef direction_mix_node(const PbrtTexture& texture, bool is_float,
                                                 PbrtSpectrumUse use);
    [[nodiscard]] PbrtNodeRef checkerboard_node(const PbrtTexture& texture, bool is_float,
                                                PbrtSpectrumUse use);
    [[nodiscard]] PbrtNodeRef bilerp_node(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use);
    [[nodiscard]] PbrtNodeRef input(const PbrtParameters& p, std::string_view name, double otherwise,
                                    bool is_float, PbrtSpectrumUse use);
    [[nodiscard]] ImageId add_image(ByteImage image, const PbrtPlace& place);
    struct Grid;
    [[nodiscard]] Vec3 find_axis(const std::vector<PbrtNodeRef>& nodes, const PbrtPlace& place);
    [[nodiscard]] ByteImage baked_image(const Grid& grid, const std::vector<PbrtNodeRef>& nodes,
                                        const PbrtCombine& combine, bool srgb, bool facing) const;
    [[nodiscard]] Grid choose_grid(const std::vector<const PbrtNode*>& leaves,
                                   const std::array<Vec2, 2>& domain, const PbrtPlace& place);

    PbrtScene& scene_;
    PbrtFiles& files_;
    SceneData& out_;
    std::map<std::string, PbrtNodeRef> made_;
    std::map<std::string, std::shared_ptr<const PbrtPixels>> pixels_;
    std::map<const ByteImage*, ImageId> shared_images_;
    int depth_ = 0;  // of references between textures
    std::size_t baked_texels_ = 0;
};

/// What a mesh needs for textures of that mapping and axis; null: nothing. `smooth`: as in pbrt, it faces
/// where its vertices' normals point.
[[nodiscard]] std::shared_ptr<const TextureProjection> make_projection(const PbrtMapping& mapping, Vec3 axis,
                                                                       bool smooth);

[[nodiscard]] PbrtNodeRef constant_node(Spectrum value);
[[nodiscard]] inline bool is_constant(const PbrtNodeRef& node) {
    return node->kind == PbrtNode::Kind::constant;
}
/// Its images, checkerboards and bilinear squares.
void collect_leaves(const PbrtNodeRef& node, std::vector<const PbrtNode*>& leaves);
/// Its mixes by direction.
void collect_direction_mixes(const PbrtNodeRef& node, std::vector<const PbrtNode*>& mixes);

}  // namespace relumine
