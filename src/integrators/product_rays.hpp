// SPDX-License-Identifier: Apache-2.0
// The unbiased variant: rays importance-sampled from reprojected radiance × BSDF × cosine [V, §3.4].
#pragma once

#include "cache/product_distribution.hpp"
#include "integrators/shading_point.hpp"
#include "radiance/incident.hpp"

namespace relumine {

/// How many rays are drawn from which distribution.
struct RayShares {
    std::uint32_t product = 0, bsdf = 0;
};

/// `bsdf_share` of the rays, at least one if it is above 0, and what n × n strata of product rays leave over.
[[nodiscard]] RayShares split_rays(std::uint32_t rays, float bsdf_share);

/// What `x` reflects towards the viewer, estimated from rays drawn from `distribution` (over the square of
/// `receiver`) and from the BSDF, weighed by the balance heuristic over both sets [Veach97, §9.2.2]. Where
/// the distribution is empty, the BSDF gets all rays. Unbiased if shares.bsdf > 0. Adds rays of
/// RayPurpose::product.
[[nodiscard]] SplitRadiance importance_sampled(const IncidentRadiance& source, const ShadingPoint& x,
                                               const SampleStream& stream, const Frame& receiver,
                                               const ProductDistribution& distribution, RayShares shares,
                                               RayCounts& counts);

}  // namespace relumine
