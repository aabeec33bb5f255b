// SPDX-License-Identifier: Apache-2.0
// Gap rays, in packets of sixteen.
#include "cache/gap_fill.hpp"

#include "base/rgbe.hpp"
#include "cache/hemisphere_map.hpp"

namespace relumine {
namespace {

/// The open bits of a cell, row after row: at most 64.
std::uint64_t open_bits(const Mask& covered, int x, int y, int k) {
    std::uint64_t bits = 0;
    for (int row = k - 1; row >= 0; --row)
        bits = bits << k | (~covered.rows[static_cast<std::size_t>(y + row)]).bits(x, k);
    return bits;
}

/// The position of the set bit with `rank` set bits below it.
int select_bit(std::uint64_t bits, std::uint32_t rank) {
    for (; rank > 0; --rank) bits &= bits - 1;
    return std::countr_zero(bits);
}

struct GapTracer {
    const IncidentRadiance& source;
    const GatherPoint& point;
    int k;
    std::uint64_t key;
    Reprojection& incident;

    void trace(std::span<const GapRay> gaps, RayCounts& counts) const {
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        StreamPacket streams;
        for (std::size_t i = 0; i < packet_size; ++i) {
            rays[i].t_max = -1;
            if (i < gaps.size()) start(gaps[i], rays[i], streams[i]);
        }
        counts.add(RayPurpose::gap, gaps.size());
        source.transport.tracer.closest_hits(rays, hits, Coherence::incoherent);
        const RadiancePacket radiance =
            incident_radiance(source, rays, hits, point.depth + 1, streams, counts);
        for (std::size_t i = 0; i < gaps.size(); ++i) {
            const bool finite = is_finite(radiance[i].total());
            counts.non_finite += finite ? 0 : 1;
            put(gaps[i], finite ? radiance[i] : SplitRadiance{});
        }
    }

    void start(const GapRay& gap, Ray& ray, SampleStream& stream) const {
        const auto bit = static_cast<std::uint32_t>(gap.y * mask_side + gap.x);
        const std::uint64_t random = hash(key, bit, 0x67617020726179);
        const auto inside = [](int index, std::uint64_t bits) {
            return (static_cast<float>(index) + unit_float(static_cast<std::uint32_t>(bits))) / mask_side;
        };
        stream = {key, bit, static_cast<std::uint32_t>(mask_bits), PointSet::sobol};
        ray.direction =
            point.frame.to_world(square_to_hemisphere({inside(gap.x, random), inside(gap.y, random >> 32)}));
        ray.origin = point.position + point.frame.n * point.offset;
        ray.t_max = infinity;
        ray.opacity_seed = stream.bits(Dim::opacity, 2 * point.depth + 2);
    }

    void put(const GapRay& gap, const SplitRadiance& found) const {
        const std::uint32_t total = pack_rgbe(found.total()), direct = pack_rgbe(found.direct);
        std::uint64_t open = open_bits(incident.covered, gap.cell_x, gap.cell_y, k);
        for (; open != 0; open &= open - 1) {
            const int bit = std::countr_zero(open);
            const auto at =
                static_cast<std::size_t>((gap.cell_y + bit / k) * mask_side + gap.cell_x + bit % k);
            incident.radiance[at] = total;
            if (!incident.direct.empty()) incident.direct[at] = direct;
        }
    }
};

}  // namespace

void choose_gap_rays(const Mask& covered, int k, std::uint64_t key, std::vector<GapRay>& rays) {
    rays.clear();
    for (int y = 0; y < mask_side; y += k)
        for (int x = 0; x < mask_side; x += k) {
            const std::uint64_t open = open_bits(covered, x, y, k);
            if (open == 0) continue;
            const auto count = static_cast<std::uint32_t>(std::popcount(open));
            const std::uint64_t random =
                hash(key, static_cast<std::uint64_t>(y * mask_side + x), 0x676170) >> 32;
            const int bit = select_bit(open, static_cast<std::uint32_t>(random * count >> 32));
            const auto byte = [](auto i) { return static_cast<std::uint8_t>(i); };
            rays.push_back({byte(x + bit % k), byte(y + bit / k), byte(x), byte(y), byte(count)});
        }
}

void fill_gaps(const IncidentRadiance& source, const GatherPoint& point, int k, std::uint64_t key,
               Reprojection& incident, std::vector<GapRay>& rays, RayCounts& counts) {
    choose_gap_rays(incident.covered, k, key, rays);
    const GapTracer tracer{source, point, k, key, incident};
    const std::span<const GapRay> all(rays);
    for (std::size_t i = 0; i < all.size(); i += packet_size)
        tracer.trace(all.subspan(i, std::min(packet_size, all.size() - i)), counts);
    incident.lit = incident.lit | ~incident.covered;
    incident.covered = ~Mask{};
}

}  // namespace relumine
