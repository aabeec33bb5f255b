// SPDX-License-Identifier: Apache-2.0
// Making and using radiance records.
#include "rivals/harmonic_cache.hpp"

#include "shading/material.hpp"

namespace relumine {
namespace {

constexpr std::size_t padded_most = (harmonic_count(most_bands) + 7) / 8 * 8;
using Coefficients = std::array<std::array<float, padded_most>, RadianceHarmonics::quantities>;

/// Eight sums side by side, which compilers can keep in a vector.
float dot(const float* a, const float* b, std::size_t padded) {
    std::array<float, 8> sums{};
    for (std::size_t i = 0; i < padded; i += 8)
        for (std::size_t k = 0; k < 8; ++k) sums[k] += a[i + k] * b[i + k];
    float sum = 0;
    for (const float s : sums) sum += s;
    return sum;
}

/// Adds what a record expects `x` metres along its s and `y` along its t.
void add_expected(const RadianceHarmonics& record, float weight, float x, float y, Coefficients& sum) {
    for (std::size_t q = 0; q < sum.size(); ++q) {
        const float *value = record.of(q, 0).data(), *along_s = record.of(q, 1).data(),
                    *along_t = record.of(q, 2).data();
        for (std::size_t i = 0; i < record.stride(); ++i)
            sum[q][i] += weight * (value[i] + x * along_s[i] + y * along_t[i]);
    }
}

/// The frame of a point turned so that its x lies under the viewer.
Frame view_frame(const Frame& f, LocalDir w_out) {
    const float r = std::sqrt(sqr(w_out.v.x) + sqr(w_out.v.y));
    if (!(r > 0)) return f;
    const Vec3 s = (f.s * w_out.v.x + f.t * w_out.v.y) / r;
    return {s, cross(f.n, s), f.n};
}

Spectrum nonnegative(Spectrum s) { return {std::max(s.r, 0.0f), std::max(s.g, 0.0f), std::max(s.b, 0.0f)}; }

/// How far light on the surface stays alike, by what the harmonics say of its irradiance and its gradient.
float harmonic_change_length(const RadianceHarmonics& radiance, const Frame& frame,
                             const LobeHarmonics& lobes) {
    std::array<float, padded_most> world{};
    HarmonicRotation(lobes.bands(), frame).turn(lobes.cosine(), world);
    std::array<float, RadianceHarmonics::orders> sums{};
    for (std::size_t order = 0; order < sums.size(); ++order) {
        constexpr std::array weights{0.2126f, 0.7152f, 0.0722f};
        for (std::size_t q = 0; q < RadianceHarmonics::quantities; ++q)
            sums[order] +=
                weights[q % 3] * dot(world.data(), radiance.of(q, order).data(), radiance.stride());
    }
    const float change = std::sqrt(sqr(sums[1]) + sqr(sums[2]));
    return change > 0 ? std::max(sums[0], 0.0f) / change : infinity;
}

}  // namespace

HarmonicCache::HarmonicCache(const RivalSettings& settings, int bands, Masking masking,
                             const IncidentRadiance& source, const BrightSplit& split)
    : grid_(polar_grid(Rings::even, settings.rays)),
      lobes_(bands, masking),
      source_(source),
      split_(split),
      sites_(settings.accuracy) {}

std::optional<MetallicRoughness> HarmonicCache::holds(const Bsdf& bsdf) const {
    const auto layers = as_layers(bsdf);
    const bool has_lobe = layers && !(is_black(layers->specular_f0) && is_black(layers->specular_f90));
    if (!has_lobe || layers->smooth || is_anisotropic(layers->ggx)
        || layers->ggx.alpha < least_lobe_alpha(lobes_.bands()))
        return {};
    return layers;
}

HarmonicCache::Record HarmonicCache::seen_from(const SitePoint& point, RayCounts& rays, Site& site) const {
    const PolarHemisphere seen = trace_polar(source_, split_, point, grid_, rays);
    Record record{point.frame.s, point.frame.t, radiance_harmonics(seen, point.frame, lobes_.bands())};
    const float change = harmonic_change_length(record.radiance, point.frame, lobes_);
    const SiteRadius radius =
        site_radius(seen.harmonic_distance(), change, point.footprint, sites_.accuracy());
    for (std::size_t q = 0; q < RadianceHarmonics::quantities; ++q)
        for (const std::size_t order : {1u, 2u})
            for (float& derivative : record.radiance.of(q, order)) derivative *= radius.gradient_scale;
    site = {point.position, point.frame.n, radius.radius, radius.least};
    return record;
}

void HarmonicCache::place(const PixelRect& frame,
                          const std::function<const SitePoint*(int x, int y)>& point_at, float share,
                          SiteRun& run) {
    const SiteMaker maker{[&](std::size_t count) { records_.resize(count); },
                          [&](std::size_t id, const SitePoint& point, RayCounts& rays, CacheCounts& counts) {
                              Site site;
                              records_[id] = seen_from(point, rays, site);
                              ++counts.records;
                              counts.record_bytes +=
                                  sizeof(Site) + sizeof(Record) + records_[id].radiance.bytes();
                              return site;
                          }};
    place_sites(frame, point_at, share, maker, sites_, run);
}

ReflectedLight HarmonicCache::reflected(const SitePoint& point, Spectrum diffuse,
                                        const MetallicRoughness& layers, LocalDir w_out,
                                        std::vector<FoundSite>& found, RayCounts& rays,
                                        CacheCounts& counts) const {
    {
        const StepTimer timer(counts, CacheStep::lookup);
        sites_.find(point.position, point.frame.n, found);
    }
    Coefficients radiance{};
    float weights = 0;
    std::size_t stride = 0;
    for (const FoundSite& f : found) {
        const Record& record = records_[f.id];
        const Vec3 offset = point.position - sites_[f.id].position;
        stride = record.radiance.stride();
        add_expected(record.radiance, f.weight, relumine::dot(offset, record.s),
                     relumine::dot(offset, record.t), radiance);
        weights += f.weight;
    }
    if (found.empty()) {
        const StepTimer timer(counts, CacheStep::create);
        Site site;
        const Record own = seen_from(point, rays, site);
        stride = own.radiance.stride();
        add_expected(own.radiance, 1, 0, 0, radiance);
        weights = 1;
        ++counts.records;
    }
    const StepTimer timer(counts, CacheStep::shade);
    SpectralHarmonics local;
    lobes_.reflection(diffuse, layers, cos_theta(w_out), local);
    const HarmonicRotation rotation(lobes_.bands(), view_frame(point.frame, w_out));
    std::array<float, RadianceHarmonics::quantities> sums{};
    for (std::size_t channel = 0; channel < 3; ++channel) {
        std::array<float, padded_most> world{};
        rotation.turn(local[channel], world);
        for (const std::size_t q : {channel, channel + 3})
            sums[q] = dot(world.data(), radiance[q].data(), stride) / weights;
    }
    return {nonnegative({sums[0], sums[1], sums[2]}), nonnegative({sums[3], sums[4], sums[5]})};
}

}  // namespace relumine
