// SPDX-License-Identifier: Apache-2.0
// Mitsuba's BSDFs and area emitters as our materials.
#pragma once

#include <functional>
#include <map>
#include <tuple>

#include "scene/mitsuba_textures.hpp"

namespace relumine {

/// A material that takes shape: graphs that are not baked yet.
struct MitsubaDraft {
    Material material;
    PbrtPlace place;
    PbrtNodeRef color = constant_node(Spectrum{0.5f});
    std::function<Spectrum(Spectrum)> recolor;  // to our base colour; empty: the same
    PbrtNodeRef alpha;                          // GGX's, along u; null: perfectly smooth
    PbrtNodeRef alpha_v;                        // null: the same
    float aspect = 1;      // of the principled BSDF: along u α is divided by it, along v multiplied
    bool squared = false;  // `alpha` holds its root, as our roughness does
    PbrtNodeRef opacity = constant_node(Spectrum{1});
    PbrtNodeRef metallic;  // null: the material's number
    PbrtNodeRef normal;    // of a normal map, or null
    bool visible = true;
    bool inside_out = false;  // an index below 1 is one above, seen from the other side
    bool two_sided = false;
};

class MitsubaMaterials {
  public:
    MitsubaMaterials(MitsubaScene& scene, SceneData& out) : scene_(scene), out_(out), textures_(scene, out) {}

    /// What a shape's mesh needs from its material.
    struct Binding {
        MaterialId material{};
        bool visible = true;      // false: `null`, or cut out whole
        bool by_domain = false;   // baked over one range of u and v
        bool inside_out = false;  // the mesh's sides must change places
        bool normal_map = false;
    };
    /// `bsdf` and `emitter` may be null. `uv_domain`: the mesh's range of u and v (upwards).
    [[nodiscard]] Binding bind(const MitsubaElement* bsdf, const MitsubaElement* emitter,
                               const std::array<Vec2, 2>& uv_domain);
    /// Checks BSDFs that no shape uses.
    void check_unused(const MitsubaElement& root);

  private:
    void fill(const MitsubaElement& bsdf, MitsubaDraft& draft);
    void fill_surface(MitsubaProperties& p, MitsubaDraft& draft);
    void diffuse(MitsubaProperties& p, MitsubaDraft& draft);
    void dielectric(MitsubaProperties& p, MitsubaDraft& draft);
    void conductor(MitsubaProperties& p, MitsubaDraft& draft);
    void plastic(MitsubaProperties& p, MitsubaDraft& draft);
    void principled(MitsubaProperties& p, MitsubaDraft& draft);
    void nested(MitsubaProperties& p, MitsubaDraft& draft);
    void blend(MitsubaProperties& p, MitsubaDraft& draft);
    void read_alpha(MitsubaProperties& p, MitsubaDraft& draft);
    [[nodiscard]] double relative_ior(MitsubaProperties& p, const char* inside);
    void emit(const MitsubaElement& emitter, MitsubaDraft& draft, const std::array<Vec2, 2>& domain,
              Binding& binding);
    void bake(MitsubaDraft& draft, const std::array<Vec2, 2>& domain, Binding& binding);
    void apply(const PbrtBaked& baked, std::optional<TextureRef>& ref, Binding& binding);
    void note_sides(const MitsubaDraft& draft);

    MitsubaScene& scene_;
    SceneData& out_;
    MitsubaTextures textures_;
    using Key = std::tuple<const MitsubaElement*, const MitsubaElement*, std::array<float, 4>>;
    std::map<Key, Binding> made_;
    int depth_ = 0;
    bool noted_sides_ = false;
};

}  // namespace relumine
