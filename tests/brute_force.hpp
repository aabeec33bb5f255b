// SPDX-License-Identifier: Apache-2.0
// Light transport as plain as it can be written: rectangles, every one tested for every ray, directions
// uniform in the cosine, no light samples but of points, no tree, no packets, double precision. It shares
// with the renderer nothing but the description of scenes, so that an error of one is not an error of the
// other.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "relumine/scene.hpp"

namespace relumine::testing {

using Triple = std::array<double, 3>;  // a point, a direction or RGB

/// A parallelogram at `corner`, spanned by `u` and `v`; both sides reflect and emit.
struct Panel {
    Triple corner, u, v;
    Triple colour, emission{};
    double alpha = 0;  // 0: diffuse; else a metal with a GGX lobe of this α, `colour` at normal incidence
};

/// The camera looks along −Z and sees tan θ ≤ `extent` to every side. Where rays leave, they see `sky`.
struct BruteForceScene {
    std::vector<Panel> panels;
    Triple sky{};
    Triple lamp{}, lamp_intensity{};  // a point light; none where black
    Triple eye{};
    double extent = 0.5;
};

/// The same scene for the renderer.
Scene build(const BruteForceScene& scene);

/// One picture of `side` × `side` pixels, each the mean of `paths` paths through its centre, as means of
/// blocks of `block` × `block` pixels over all channels. Paths end where less than 1e-4 of the light would
/// get through.
std::vector<double> brute_force_blocks(const BruteForceScene& scene, int side, int block, int paths,
                                       std::uint32_t seed);

/// Direct light on the diffuse `receiver` from the diffuse emitter `lamp`, neither hidden nor partly below
/// the horizon: by Lambert's closed form, at the centre of every pixel; blocks as above. Every pixel must see
/// the receiver first.
std::vector<double> lit_by_polygon_blocks(const BruteForceScene& scene, const Panel& receiver,
                                          const Panel& lamp, int side, int block);

}  // namespace relumine::testing
