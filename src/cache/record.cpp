// SPDX-License-Identifier: Apache-2.0
// Making a record: rays, layers, surfels.
#include "cache/record.hpp"

#include <algorithm>

#include "base/rgbe.hpp"
#include "cache/surfel_merge.hpp"

namespace relumine {
namespace {

/// Metres; infinite where nothing is hit.
float harmonic_mean_distance(const std::vector<TexelSample>& texels) {
    double sum = 0;
    for (const TexelSample& texel : texels) sum += 1 / static_cast<double>(texel.distance);
    return sum > 0 ? static_cast<float>(static_cast<double>(texels.size()) / sum) : infinity;
}

std::vector<std::uint32_t> packed(const std::vector<TexelSample>& texels, Spectrum TexelSample::*radiance) {
    std::vector<std::uint32_t> out(texels.size() + surfel_padding);
    std::ranges::transform(texels, out.begin(),
                           [&](const TexelSample& texel) { return pack_rgbe(texel.*radiance); });
    return out;
}

}  // namespace

Record make_record(const IncidentRadiance& source, const GatherPoint& point, const RecordSettings& settings,
                   const ReachLimits& reach, std::uint64_t key, RayCounts& rays) {
    const std::vector<TexelSample> texels = trace_hemisphere(source, point, settings.side, key, rays);
    const DepthLayers layers = sort_into_layers(texels, settings.layers);
    Record record{point.position,
                  point.frame,
                  settings.side,
                  {},
                  {},
                  {},
                  layers.nearest,
                  harmonic_mean_distance(texels),
                  0};
    record.reach = reach.of(record.harmonic_distance);
    record.radiance = packed(texels, &TexelSample::radiance);
    if (source.reflects()) record.direct = packed(texels, &TexelSample::direct);
    record.surfels = merge_surfels(texels, layers, point, settings.side, {.reuse_distance = record.reach});
    return record;
}

}  // namespace relumine
