// SPDX-License-Identifier: Apache-2.0
// Paths: what a ray brings back, by following it from surface to surface [Veach97].
#pragma once

#include "base/ray_counts.hpp"
#include "base/sample_stream.hpp"
#include "base/tile.hpp"
#include "radiance/transport.hpp"

namespace relumine {

/// A path under way: the ray that was traced last, what it hit, and what is known of how it came about.
struct PathState {
    Ray ray;
    Hit hit;
    std::uint32_t depth = 0;        // scattering vertices so far
    std::uint32_t scatterings = 0;  // those among them that are not delta; sorts light into SplitRadiance
    Spectrum throughput{1};
    float eta_scale = 1;  // undoes what refraction did to the throughput, for Russian roulette
    float bsdf_pdf = 0;   // of the ray's direction, per steradian; 0: light sampling could not have found it
                          // (camera, delta)
    bool count_emission =
        true;           // whether what `hit` emits (or the environment at a miss) is still to be counted
    bool alive = true;  // whether there is anything to follow
};

inline constexpr std::uint32_t unlimited_depth = 0xffffffffu;

using PathPacket = std::array<PathState, packet_size>;
using StreamPacket = std::array<SampleStream, packet_size>;
using RadiancePacket = std::array<SplitRadiance, packet_size>;

/// Radiance along each living path's ray from its hit on: next-event estimation with MIS, BSDF sampling,
/// Russian roulette from the fifth vertex on. Unbiased for paths of up to `max_depth` scattering vertices in
/// all. The paths are followed in step, so that their rays are traced and their random numbers drawn as
/// packets: the same sixteen paths must always go together, and all that live be of the same depth.
[[nodiscard]] RadiancePacket path_radiance(const Transport& t, PathPacket paths, std::uint32_t max_depth,
                                           const StreamPacket& streams, RayCounts& rays);

/// The vertex where the path's ray has hit; attenuates the throughput where the ray went through a solid.
[[nodiscard]] Vertex make_vertex(const Transport& t, PathState& path, const SampleStream& stream);

/// Turns the path's ray into a direction drawn from the BSDF; the hit is not known yet. Where the path ends,
/// it is not alive after.
void scatter_path(PathState& path, const Vertex& vertex, const SampleStream& stream);

/// What the path's ray brings straight from a light: emission at the hit, or the environment at a miss.
[[nodiscard]] Spectrum arriving_emission(const Transport& t, const PathState& path,
                                         const SurfacePoint* hit_point);

}  // namespace relumine
