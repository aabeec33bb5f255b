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
    // With which density guides, besides, had drawn the ray's direction as one to a light:
    // PathGuide::sky_pdf.
    float sky_pdf = 0, light_share = 1;
};

inline constexpr std::uint32_t unlimited_depth = 0xffffffffu;

/// Russian roulette may end paths of this many scattering vertices.
constexpr bool may_end(std::uint32_t depth) { return depth > 4; }
/// The most it lets survive: even paths that have lost nothing end at some time.
constexpr float max_survival(std::uint32_t depth) { return depth < 256 ? 1.0f : 0.95f; }

using PathPacket = std::array<PathState, packet_size>;
using StreamPacket = std::array<SampleStream, packet_size>;
using RadiancePacket = std::array<SplitRadiance, packet_size>;

/// The most packets of paths that are followed together.
inline constexpr std::size_t batch_packets = 8;

/// Radiance along each living path's ray from its hit on: next-event estimation with MIS, BSDF sampling,
/// Russian roulette from the fifth vertex on. Unbiased for paths of up to `max_depth` scattering vertices in
/// all. At most batch_packets packets; the results go to `sums`, which begin at zero. The paths are followed
/// in step, so that their rays are traced, their surfaces shaded and their random numbers drawn as packets,
/// and those that live on move together: the same paths must always go together, and all that live be of the
/// same depth.
void path_radiance(const Transport& t, std::span<const PathPacket> paths, std::uint32_t max_depth,
                   std::span<const StreamPacket> streams, std::span<RadiancePacket> sums, RayCounts& rays);

/// Gives the throughput the colour of the panes that the path's ray has passed on the way to its hit.
inline void tint(const Transport& t, PathState& path) {
    if (t.tracer.has_coloured_panes()) path.throughput *= t.tracer.tint(path.ray, path.hit.t);
}

/// The vertex where the path's ray has hit; attenuates the throughput where the ray went through a solid.
[[nodiscard]] Vertex make_vertex(const Transport& t, PathState& path, const SampleStream& stream);

/// Adds radiance to the sum that light of so many scatterings belongs to.
inline void add(SplitRadiance& sum, std::uint32_t scatterings, Spectrum radiance) {
    (scatterings == 0 ? sum.emission : scatterings == 1 ? sum.direct : sum.indirect) += radiance;
}

/// Ends paths by their throughput, or makes up for those that were ended.
[[nodiscard]] bool survives(PathState& path, float u);

/// scatter_path with a direction that is drawn already.
void scatter(PathState& path, const Vertex& vertex, const std::optional<BsdfSample>& drawn,
             std::uint32_t opacity_seed);

/// Turns the path's ray into a direction drawn from the BSDF; the hit is not known yet. Where the path ends,
/// it is not alive after.
void scatter_path(PathState& path, const Vertex& vertex, const SampleStream& stream);

/// What the path's ray brings straight from a light: emission at the hit, or the environment at a miss.
[[nodiscard]] Spectrum arriving_emission(const Transport& t, const PathState& path,
                                         const SurfacePoint* hit_point);

}  // namespace relumine
