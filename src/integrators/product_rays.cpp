// SPDX-License-Identifier: Apache-2.0
// Product rays in packets.
#include "integrators/product_rays.hpp"

#include "integrators/gather_rays.hpp"

namespace relumine {
namespace {

constexpr std::uint64_t product_purpose = 0x70726f64756374, bsdf_purpose = 0x62736466;

/// Fewer strata along each side are not worth leaving rays over for.
constexpr std::uint32_t fewest_strata = 16;

class ProductRays {
  public:
    ProductRays(const IncidentRadiance& source, const ShadingPoint& x, const SampleStream& stream,
                const Frame& receiver, const ProductDistribution& distribution, RayShares shares)
        : source_(source),
          point_(x.vertex.point),
          vertex_(x.vertex),
          depth_(x.path.depth),
          stream_(stream),
          receiver_(receiver),
          distribution_(distribution),
          shares_(shares),
          coherence_(stream.set == PointSet::stratified ? Coherence::coherent : Coherence::incoherent) {}

    [[nodiscard]] SplitRadiance estimate(RayCounts& counts) const {
        SplitRadiance sum;
        for (std::uint32_t first = 0; first < shares_.product + shares_.bsdf; first += packet_size)
            add_packet(first, sum, counts);
        return sum;
    }

  private:
    void add_packet(std::uint32_t first, SplitRadiance& sum, RayCounts& counts) const {
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        std::array<Spectrum, packet_size> weights;
        StreamPacket streams;
        for (std::uint32_t lane = 0; lane < packet_size; ++lane) {
            rays[lane].t_max = -1;
            if (first + lane < shares_.product + shares_.bsdf)
                rays[lane] = draw(first + lane, streams[lane], weights[lane]);
            if (rays[lane].t_max >= 0) counts.add(RayPurpose::product);
        }
        source_.transport.tracer.closest_hits(rays, hits, coherence_);
        const RadiancePacket incident = incident_radiance(source_, rays, hits, depth_ + 1, streams, counts);
        for (std::size_t i = 0; i < packet_size; ++i) {
            if (rays[i].t_max < 0) continue;
            sum.direct += weights[i] * incident[i].direct;
            sum.indirect += weights[i] * incident[i].indirect;
        }
    }

    /// Ray number `i`; t_max < 0 where it would bring nothing.
    Ray draw(std::uint32_t i, SampleStream& stream, Spectrum& weight) const {
        const Ray none{{}, {}, -1, 0};
        const bool product = i < shares_.product;
        stream = product ? gather_stream(stream_, product_purpose, i, shares_.product)
                         : gather_stream(stream_, bsdf_purpose, i - shares_.product, shares_.bsdf);
        const std::optional<WorldDir> w_in = product ? product_direction(stream) : bsdf_direction(stream);
        if (!w_in || !sides_agree(point_, *w_in)) return none;
        weight = weight_of(*w_in);
        if (is_black(weight)) return none;
        return {ray_origin(point_, *w_in), *w_in, infinity, stream.bits(Dim::opacity, 2 * depth_ + 2)};
    }

    [[nodiscard]] WorldDir product_direction(const SampleStream& stream) const {
        return receiver_.to_world(distribution_.sample(direction_numbers(stream, depth_)).w_in);
    }

    [[nodiscard]] std::optional<WorldDir> bsdf_direction(const SampleStream& stream) const {
        const BsdfRandom u{has_lobes(vertex_.bsdf) ? stream.next1(Dim::lobe, depth_) : 0.0f,
                           direction_numbers(stream, depth_)};
        const auto scattered = sample(vertex_.bsdf, vertex_.w_out, u);
        if (!scattered) return {};
        return point_.frame.to_world(scattered->w_in);
    }

    /// f·|cos θ| over the density of all rays together.
    [[nodiscard]] Spectrum weight_of(WorldDir w_in) const {
        const BsdfValue bsdf = evaluate(vertex_.bsdf, vertex_.w_out, point_.frame.to_local(w_in));
        const float product = shares_.product > 0 ? distribution_.pdf(receiver_.to_local(w_in)) : 0;
        const float density =
            static_cast<float>(shares_.product) * product + static_cast<float>(shares_.bsdf) * bsdf.pdf;
        return density > 0 ? bsdf.value / density : Spectrum{};
    }

    const IncidentRadiance& source_;
    const SurfacePoint& point_;
    const Vertex& vertex_;
    std::uint32_t depth_;
    const SampleStream& stream_;
    const Frame& receiver_;
    const ProductDistribution& distribution_;
    RayShares shares_;
    Coherence coherence_;  // stratified rays are sorted by direction
};

}  // namespace

RayShares split_rays(std::uint32_t rays, float bsdf_share) {
    auto bsdf = static_cast<std::uint32_t>(std::lround(bsdf_share * static_cast<float>(rays)));
    if (bsdf_share > 0) bsdf = std::max(bsdf, 1u);
    std::uint32_t product = rays - std::min(rays, bsdf);
    const std::uint32_t strata = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(product))) / 4 * 4;
    if (bsdf > 0 && strata >= fewest_strata) product = strata * strata;
    return {product, bsdf > 0 ? rays - product : 0};
}

SplitRadiance importance_sampled(const IncidentRadiance& source, const ShadingPoint& x,
                                 const SampleStream& stream, const Frame& receiver,
                                 const ProductDistribution& distribution, RayShares shares,
                                 RayCounts& counts) {
    if (distribution.empty() && shares.bsdf > 0) shares = {0, shares.product + shares.bsdf};
    if (distribution.empty() && shares.bsdf == 0) return {};
    return ProductRays(source, x, stream, receiver, distribution, shares).estimate(counts);
}

}  // namespace relumine
