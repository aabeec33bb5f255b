// SPDX-License-Identifier: Apache-2.0
// pbrt's materials and area lights as our material: exact where it can say the same, else the nearest.
#pragma once

#include "scene/pbrt_textures.hpp"

namespace relumine {

/// What the diffuse base under pbrt's dielectric coat reflects, with the light that the coat throws back.
class CoatedAlbedo {
  public:
    /// `bounces`: how often light meets the base at most.
    CoatedAlbedo(double eta, double thickness, int bounces);

    /// CoatedDiffuse::base for a base of albedo `albedo`, times `entering()`, which brings it to [0, 1].
    [[nodiscard]] float base(float albedo) const;
    /// The share of diffuse light that the coat lets in.
    [[nodiscard]] double entering() const { return entering_; }

  private:
    double entering_, through_, trapped_;  // shares of light: on its way in and out; reflected back inside
    int bounces_;
};

/// Makes materials on demand, one for each combination of material, area light and cut-out.
class PbrtMaterials {
  public:
    PbrtMaterials(PbrtScene& scene, PbrtFiles& files, SceneData& out)
        : scene_(scene), files_(files), out_(out), textures_(scene, files, out) {}

    /// What a shape's mesh needs from its material.
    struct Binding {
        MaterialId material{};
        std::optional<PbrtMapping> mapping;  // of uv set 1
        Vec3 axis;                           // that surfaces may face; 0: it does not matter
        bool visible = true;                 // false: an interface between media, or cut out whole
        bool by_domain = false;              // baked over one range of u and v
        bool inside_out = false;             // the mesh's sides must change places
    };

    /// Whether the material reads textures by uv, so that the mesh needs texture coordinates.
    [[nodiscard]] bool needs_uv(const PbrtShape& shape);
    /// `area`: of the shape's triangle or surface that emits, in world space; for lights given by power.
    [[nodiscard]] Binding bind(const PbrtShape& shape, const std::array<Vec2, 2>& uv_domain, double area);
    /// Whether the shape's light is given by its power, so that it depends on the area.
    [[nodiscard]] bool by_power(const PbrtShape& shape) const;
    /// Checks the parameters of materials that no shape uses.
    void check_unused();

  private:
    [[nodiscard]] const PbrtEntity& find(const PbrtMaterialRef& ref) const;
    [[nodiscard]] Binding make(const PbrtShape& shape, const PbrtEntity& entity,
                               const std::array<Vec2, 2>& domain, double area);
    struct Draft;
    void fill(const PbrtEntity& entity, Draft& draft);
    void diffuse(const PbrtEntity& entity, Draft& draft);
    void coated_diffuse(const PbrtEntity& entity, Draft& draft);
    void conductor(const PbrtEntity& entity, Draft& draft);
    void coated_conductor(const PbrtEntity& entity, Draft& draft);
    void dielectric(const PbrtEntity& entity, Draft& draft);
    void diffuse_transmission(const PbrtEntity& entity, Draft& draft);
    void mix(const PbrtEntity& entity, Draft& draft);
    void unsupported(const PbrtEntity& entity, Draft& draft);
    void read_roughness(const PbrtParameters& p, const std::string& prefix, Draft& draft);
    void read_surface(const PbrtParameters& p, Draft& draft);
    [[nodiscard]] double read_eta(const PbrtParameters& p, std::string_view name);
    void emit(const PbrtEntity& light, double area, Draft& draft);
    void apply(const PbrtBaked& baked, std::optional<TextureRef>& ref, Draft& draft);
    void finish_textures(Draft& draft);
    void finish_roughness(Draft& draft);

    PbrtScene& scene_;
    PbrtFiles& files_;
    SceneData& out_;
    PbrtTextures textures_;
    std::map<std::string, Binding> made_;
    std::map<std::string, bool> needs_uv_;
    int mix_depth_ = 0;
};

}  // namespace relumine
