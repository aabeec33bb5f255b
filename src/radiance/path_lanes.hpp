// SPDX-License-Identifier: Apache-2.0
// Sixteen paths side by side, and the steps of a path that are computed in SIMD lanes.
//
// The scalar functions named here are the definitions: every lane gets the bits that they give.
#pragma once

#include "base/lanes.hpp"
#include "radiance/path.hpp"

namespace relumine {

/// PathState for sixteen paths that have scattered equally often.
struct PathLanes {
    RayLanes ray;
    HitLanes hit;
    Lanes<std::uint32_t> scatterings;
    SpectrumLanes throughput;
    Lanes<float> eta_scale, bsdf_pdf, sky_pdf, light_share;
    LaneMask count_emission, alive;

    [[nodiscard]] PathState get(std::size_t lane, std::uint32_t depth) const;
    void set(std::size_t lane, const PathState& path);
    /// Puts another packet's path into a lane.
    void take(std::size_t lane, const PathLanes& other, std::size_t other_lane);
};

/// The triangles that rays have hit, in world space: what surface_point makes of a triangle without a normal
/// map.
struct TriangleLanes {
    std::array<Vec3Lanes, 3> corners;
    Vec3Lanes normal;         // of ShadingTriangle
    Lanes<float> u, v;        // barycentric weights of the second and third corner
    Vec3Lanes lobe_axis;      // where `oriented`: of ShadingTriangle
    Lanes<float> winding{};   // −1 where the order of the corners is reversed, else 1
    Vec3Lanes ray_direction;  // towards the surface
    bool oriented = false;    // whether any lane has a lobe axis

    void set(std::size_t lane, const ShadingTriangle& triangle, const Hit& hit, Vec3 direction);
};

/// What a step asks of SurfacePoint and Vertex.
struct VertexLanes {
    Vec3Lanes position, geometric_normal, s, t, n, w_out;  // all in world space but w_out
    Lanes<float> offset;
};

/// MetallicRoughness with a rough specular lobe, or none.
struct LayerLanes {
    SpectrumLanes diffuse, coat_f0, coat_f90, specular_f0, specular_f90;
    Lanes<float> alpha;
    LaneMask separable;
    Lanes<float> stretch_x, stretch_y;  // where `stretched`
    bool specular = false;              // whether any lane has more than the diffuse base
    bool stretched = false;             // whether any lane's lobe is anisotropic

    void set(std::size_t lane, const MetallicRoughness& layers);
};

/// What `set` of both leaves out for a lane with an anisotropic lobe. After the first such lane all others
/// are isotropic until they are set so; `oriented` and `stretched` are the caller's to take back together.
void set_anisotropy(std::size_t lane, Vec3 lobe_axis, const Ggx& ggx, TriangleLanes& triangles,
                    LayerLanes& layers);

/// Light that each path will have received if nothing blocks its ray.
struct ShadowLanes {
    RayLanes rays;           // t_max < 0 where there is none
    SpectrumLanes radiance;  // reflected, times the path's throughput
    Lanes<std::uint32_t> scatterings;

    /// Puts another packet's ray into a lane.
    void take(std::size_t lane, const ShadowLanes& other, std::size_t other_lane);
};

/// The numbers that choose a direction and decide whether the path goes on.
struct ScatterNumbers {
    Lanes<float> lobe, direction_x, direction_y, roulette;
    Lanes<std::uint32_t> opacity_seed{};
    bool may_end = false;  // whether `roulette` is asked
    float max_survival = 1;
};

/// surface_point, and w_out in its frame.
void locate(const TriangleLanes& triangles, VertexLanes& vertices);

/// propose_direct_light for the lanes that have drawn a light; the others get no shadow ray.
void propose_direct_light(const VertexLanes& vertices, const LayerLanes& layers, const LightLanes& lights,
                          const SpectrumLanes& throughput, ShadowLanes& shadows);

/// Scatters the paths of `lanes`, then lets Russian roulette decide; leaves the others alone.
void scatter(const VertexLanes& vertices, const LayerLanes& layers, const ScatterNumbers& numbers,
             const LaneMask& lanes, PathLanes& paths);

}  // namespace relumine
