// SPDX-License-Identifier: Apache-2.0
// A material between pbrt's parameters and ours.
#pragma once

#include "scene/pbrt_materials.hpp"

namespace relumine {

/// A material on the way: ours, and the nodes that its textures are baked from.
struct PbrtMaterials::Draft {
    Material material;
    PbrtPlace place;
    std::string type;
    PbrtNodeRef color = constant_node(Spectrum{0.5f});  // before `recolor`
    std::function<Spectrum(Spectrum)> recolor;          // to our base colour; empty: the same
    PbrtNodeRef roughness;                              // as pbrt says it, along u; null: perfectly smooth
    PbrtNodeRef roughness_v;                            // null: the same
    bool remap = true;
    PbrtNodeRef alpha = constant_node(Spectrum{1});
    std::optional<PbrtMapping> mapping;
    Vec3 axis;  // that surfaces may face; 0: it does not matter
    std::array<Vec2, 2> domain{};
    PbrtNodeRef normal;         // of the normal map, or null
    PbrtNodeRef transmittance;  // diffuse; null: none
    bool visible = true, by_domain = false;
    bool inside_out = false;  // an index below 1 is one above, seen from the other side
};

}  // namespace relumine
