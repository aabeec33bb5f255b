// SPDX-License-Identifier: Apache-2.0
// Rays through rings and sectors, sixteen at a time.
#include "rivals/polar_hemisphere.hpp"

#include "base/hash.hpp"

namespace relumine {
namespace {

class PolarTracer {
  public:
    PolarTracer(const IncidentRadiance& source, const BrightSplit& split, const SitePoint& site,
                PolarHemisphere& out, RayCounts& counts)
        : source_(source), split_(split), site_(site), out_(out), counts_(counts) {}

    void trace(std::size_t first) {
        const std::size_t count = std::min(packet_size, out_.samples.size() - first);
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            rays_[lane].t_max = -1;
            if (lane < count) start(first + lane, lane);
        }
        std::array<Hit, packet_size> hits;
        source_.transport.tracer.closest_hits(rays_, hits, Coherence::coherent);
        const RadiancePacket found =
            incident_radiance(source_, rays_, hits, site_.depth + 1, streams_, counts_);
        for (std::size_t lane = 0; lane < count; ++lane)
            if (rays_[lane].t_max >= 0) put(out_.samples[first + lane], rays_[lane], hits[lane], found[lane]);
    }

  private:
    void start(std::size_t stratum, std::size_t lane) {
        const auto number = static_cast<std::uint32_t>(stratum);
        const auto sectors = static_cast<std::uint32_t>(out_.grid.sectors);
        const std::uint64_t random = hash(site_.key, number, 0x706f6c6172);
        const float ring =
                        static_cast<float>(number / sectors) + unit_float(static_cast<std::uint32_t>(random)),
                    sector = static_cast<float>(number % sectors)
                             + unit_float(static_cast<std::uint32_t>(random >> 32));
        PolarSample& sample = out_.samples[stratum];
        sample.direction = out_.grid.direction(ring, sector);
        const WorldDir direction = site_.frame.to_world(sample.direction);
        streams_[lane] = {site_.key, number, static_cast<std::uint32_t>(out_.grid.size()), PointSet::sobol};
        sample.open = dot(direction.v, site_.geometric_normal) > 0;
        if (!sample.open) return;
        counts_.add(RayPurpose::record);
        rays_[lane] = {site_.position + site_.geometric_normal * site_.offset, direction, infinity,
                       streams_[lane].bits(Dim::opacity, 2 * site_.depth + 2)};
    }

    void put(PolarSample& sample, const Ray& ray, const Hit& hit, const SplitRadiance& found) {
        if (hit) sample.distance = hit.t;
        if (!is_finite(found.total())) {
            ++counts_.non_finite;
            return;
        }
        sample.direct = split_direct(source_.transport, split_, ray, hit, found.direct).direct;
        sample.indirect = found.indirect;
    }

    const IncidentRadiance& source_;
    const BrightSplit& split_;
    const SitePoint& site_;
    PolarHemisphere& out_;
    RayCounts& counts_;
    std::array<Ray, packet_size> rays_;
    StreamPacket streams_;
};

}  // namespace

LocalDir PolarGrid::direction(float ring, float sector) const {
    const float z = cosine(ring), r = std::sqrt(std::max(0.0f, 1 - sqr(z))), phi = azimuth(sector);
    return {{r * std::cos(phi), r * std::sin(phi), z}};
}

PolarGrid polar_grid(Rings kind, int rays) {
    const double all = static_cast<double>(rays) * rays;
    const int rings = std::max(2, static_cast<int>(std::lround(rays / std::sqrt(static_cast<double>(pi)))));
    return {kind, rings, std::max(4, static_cast<int>(std::lround(all / rings)))};
}

float PolarHemisphere::harmonic_distance() const {
    float sum = 0;
    for (const PolarSample& s : samples) sum += 1 / s.distance;
    return sum > 0 ? static_cast<float>(samples.size()) / sum : infinity;
}

PolarHemisphere trace_polar(const IncidentRadiance& source, const BrightSplit& split, const SitePoint& site,
                            const PolarGrid& grid, RayCounts& counts) {
    PolarHemisphere hemisphere{grid, std::vector<PolarSample>(grid.size())};
    PolarTracer tracer(source, split, site, hemisphere, counts);
    for (std::size_t first = 0; first < grid.size(); first += packet_size) tracer.trace(first);
    return hemisphere;
}

DimPart split_direct(const Transport& t, const BrightSplit& split, const Ray& ray, const Hit& hit,
                     Spectrum direct) {
    if (is_black(direct)) return {};
    const bool coloured = !hit && t.tracer.has_coloured_panes();  // what arrives is not what shines
    const Spectrum shining = coloured ? t.lights.environment_radiance(ray.direction) : direct;
    const BrightSplit::Part bright =
        hit ? split.of_emission(ray, hit) : split.of_environment(ray.direction, shining);
    return {direct * (1 - bright.share), bright};
}

}  // namespace relumine
