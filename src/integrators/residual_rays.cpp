// SPDX-License-Identifier: Apache-2.0
// Residual rays and light samples.
//
//     Lo = H + Σ (f − h) / (n p) + Σ w f_bright / (b r) + Σ w f_bright / (m q)
//
// over n residual rays of density p, of which b have density r, and m light samples of density q (towards
// lights, and towards surfaces that reflect as much as lights: BrightCones). f, f_bright: dim and bright
// radiance times BSDF; h, H: the integrand in the maps and its integral; w: the power heuristic [Veach97,
// §9.2.4] between light samples and those residual rays that were drawn from the BSDF: the others know
// nothing of bright light. n and m differ from pixel to pixel; weights take the usual numbers instead, so
// that light samples can come before the rest, whose number they help to choose.
#include "integrators/residual_rays.hpp"

#include "base/hash.hpp"
#include "radiance/direct_light.hpp"
#include "shading/sampling.hpp"

namespace relumine {

/// The share of glossy lobes in a BSDF's value towards a direction, which must not be black.
class Mirroring {
  public:
    explicit Mirroring(const Vertex& vertex)
        : vertex_(vertex), lobes_(sharp_lobes(vertex.bsdf, glossy_alpha)) {}

    [[nodiscard]] float share(WorldDir direction, Spectrum value) const {
        if (!lobes_) return 0;
        const LocalDir w_in = vertex_.point.frame.to_local(direction);
        return std::clamp(1 - luminance(eval(lobes_->rest, vertex_.w_out, w_in)) / luminance(value), 0.0f,
                          1.0f);
    }

  private:
    const Vertex& vertex_;
    std::optional<SharpLobes> lobes_;
};

namespace {

constexpr std::uint64_t residual_purpose = 0x7265736964, light_purpose = 0x6272696768,
                        second_light_purpose = 0x6c69676874, second_residual_purpose = 0x6d6f7265,
                        cone_purpose = 0x636f6e65, lobe_purpose = 0x6c6f6265,
                        lobe_light_purpose = 0x6c6f62656c;

float bsdf_share(const IntegratedPoint& point) { return point.distribution.empty() ? 1 : point.bsdf_share; }

/// The rays of one camera sample among those of all the pixel's samples.
struct RayRange {
    std::uint32_t first, last, all;
};

/// On average `rays` for each of the pixel's samples, evenly spread; not a function of anything drawn.
RayRange ray_range(float rays, const SampleStream& sample, std::uint64_t purpose) {
    const float phase = unit_float(static_cast<std::uint32_t>(hash(sample.key, purpose)));
    const auto before = [&](std::uint32_t i) {
        return static_cast<std::uint32_t>(rays * static_cast<float>(i) + phase);
    };
    return {before(sample.index), before(sample.index + 1), before(std::max(sample.count, 1u)) + 1};
}

bool in_second_half(const SampleStream& stream) { return 2 * stream.index + 1 >= stream.count; }

/// `value`: of the BSDF, or of a part of it.
template <typename Value>
BsdfValue value_towards(const Vertex& vertex, WorldDir direction, const Value& value) {
    const LocalDir w_in = vertex.point.frame.to_local(direction);
    if (!(cos_theta(w_in) > 0)) return {};
    const BsdfValue bsdf = value(w_in);
    // BSDF sampling also goes where the geometric surface is in the way.
    return sides_agree(vertex.point, direction) ? bsdf : BsdfValue{{}, bsdf.pdf};
}
BsdfValue value_towards(const Vertex& vertex, WorldDir direction) {
    return value_towards(vertex, direction,
                         [&](LocalDir w_in) { return evaluate(vertex.bsdf, vertex.w_out, w_in); });
}
BsdfValue value_towards(const LobePoint& point, WorldDir direction) {
    const Vertex& vertex = point.x.vertex;
    return value_towards(vertex, direction, [&](LocalDir w_in) {
        return evaluate(point.lobes, vertex.bsdf, vertex.w_out, w_in);
    });
}

/// A direction drawn from a BSDF.
std::optional<WorldDir> draw_from(const Bsdf& bsdf, const ShadingPoint& x, const SampleStream& stream) {
    const std::uint32_t depth = x.path.depth;
    const BsdfRandom u{has_lobes(bsdf) ? stream.next1(Dim::lobe, depth) : 0.0f,
                       stream.next2(Dim::direction, depth)};
    const auto scattered = sample(bsdf, x.vertex.w_out, u);
    if (!scattered) return {};
    return x.vertex.point.frame.to_world(scattered->w_in);
}

template <typename Use>
void for_each_ray(float rays, const SampleStream& stream, std::uint64_t purpose, RayNoise& noise,
                  const Use& use) {
    const RayRange range = ray_range(rays, stream, purpose);
    noise.rays += static_cast<float>(range.last - range.first);
    for (std::uint32_t i = range.first; i < range.last; ++i)
        use(SampleStream{hash(stream.key, purpose), i, range.all, stream.set});
}

}  // namespace

/// The bright surfaces as the point sees them, and how light samples are divided between them and the lights.
void ResidualEstimator::see_cones(const ShadingPoint& x) {
    const SurfacePoint& p = x.vertex.point;
    cones_.count = 0;
    if (!settings_.split.cones().empty() && settings_.source.max_depth > x.path.depth + 1)
        cones_ = settings_.split.cones().seen_from(p.position, p.geometric_normal);
    const bool lights = !settings_.split.empty(), cones = cones_.count > 0;
    light_budget_ = settings_.budget.light * (!lights ? 0.0f : cones ? 0.5f : 1.0f);
    cone_budget_ = settings_.budget.light - light_budget_;
    if (!cones) cone_budget_ = 0;
}

void ResidualEstimator::add(const IntegratedPoint& point, RaySeries series, FoundResidual& sum) {
    see_cones(point.x);
    if (!(point.rays > 0)) return;
    sum.bright.rays = point.rays;
    const Mirroring mirroring(point.x.vertex);
    for_each_ray(point.rays, point.stream,
                 series == RaySeries::first ? residual_purpose : second_residual_purpose, sum.noise,
                 [&](const SampleStream& stream) { add_residual(point, mirroring, stream, sum); });
    sum.bright.noise.rays = sum.bright.mirrored_noise.rays = sum.noise.rays;
}

void ResidualEstimator::add_cones(const ShadingPoint& x, const SampleStream& stream, FoundCones& sum) {
    see_cones(x);
    if (!(cone_budget_ > 0)) return;
    for_each_ray(cone_budget_, stream, cone_purpose, sum.noise,
                 [&](const SampleStream& drawn) { add_cone(x, drawn, sum); });
}

void ResidualEstimator::add_light(const ShadingPoint& x, const SampleStream& stream, float rays,
                                  RaySeries series, FoundLight& sum) {
    see_cones(x);
    if (!(light_budget_ > 0) || !(rays > 0)) return;
    sum.rays = rays * light_budget_ / settings_.budget.light;
    const Mirroring mirroring(x.vertex);
    for_each_ray(sum.rays, stream, series == RaySeries::first ? light_purpose : second_light_purpose,
                 sum.noise,
                 [&](const SampleStream& drawn) { add_light_sample(x, mirroring, drawn, sum.rays, sum); });
    sum.mirrored_noise.rays = sum.noise.rays;
}

void ResidualEstimator::finish() {
    trace_residual();
    trace_light();
    trace_cones();
}

float ResidualEstimator::usual_bsdf_rays() const { return usual_bsdf_share * settings_.budget.residual; }

/// A direction from the deviations or from the BSDF.
std::optional<ResidualEstimator::Drawn> ResidualEstimator::draw(const IntegratedPoint& point,
                                                                const SampleStream& stream) {
    const std::uint32_t depth = point.x.path.depth;
    if (stream.next1(Dim::light_choice, depth) >= bsdf_share(point)) {
        const ResidualSample s = point.distribution.sample(stream.next2(Dim::direction, depth));
        return Drawn{s.direction, s.texel, false};
    }
    const std::optional<WorldDir> direction = draw_from(point.x.vertex.bsdf, point.x, stream);
    if (!direction) return {};
    return Drawn{*direction, point.integral.grid().texel_at(*direction), true};
}

/// Rays of a packet are of one depth.
void ResidualEstimator::wait_for(std::uint32_t depth) {
    if (residual_count_ > 0 && depth != depth_) trace_residual();
    depth_ = depth;
}

void ResidualEstimator::add_residual(const IntegratedPoint& point, const Mirroring& mirroring,
                                     const SampleStream& stream, FoundResidual& sum) {
    const Vertex& vertex = point.x.vertex;
    const std::uint32_t depth = point.x.path.depth;
    wait_for(depth);
    const std::optional<Drawn> drawn = draw(point, stream);
    if (!drawn) return;
    const BsdfValue bsdf = value_towards(vertex, drawn->direction);
    const float share = bsdf_share(point), rays = point.rays;
    const float guided = point.distribution.empty() ? 0 : point.distribution.pdf(drawn->texel);
    const float density = rays * ((1 - share) * guided + share * bsdf.pdf);
    if (!(density > 0)) return;
    const Spectrum h = point.exact ? point.scale * point.integral.bsdf_at(drawn->texel) : bsdf.value;
    const MapRadiance held = point.integral.radiance_at(drawn->texel);
    const bool meets_light = drawn->from_bsdf && !settings_.split.empty();
    const std::size_t lane = residual_count_++;
    residual_[lane] = {
        &sum,
        in_second_half(stream),
        drawn->texel,
        bsdf.value,
        meets_light && !is_black(bsdf.value) ? mirroring.share(drawn->direction, bsdf.value) : 0,
        {h * held.direct * point.level, h * held.indirect * point.level},
        density,
        drawn->from_bsdf ? rays * share * bsdf.pdf : 0,
        usual_bsdf_rays() * bsdf.pdf,
        drawn->from_bsdf && cone_budget_ > 0 ? cone_budget_ * pdf(cones_, drawn->direction) : 0,
        light_budget_,
        point.exact};
    residual_streams_[lane] = stream;
    residual_rays_[lane] = {ray_origin(vertex.point, drawn->direction), drawn->direction,
                            is_black(bsdf.value) ? -1 : infinity, stream.bits(Dim::opacity, 2 * depth + 2)};
    if (residual_count_ == packet_size) trace_residual();
}

void ResidualEstimator::trace_residual() {
    if (residual_count_ == 0) return;
    std::array<Hit, packet_size> hits;
    for (std::size_t lane = residual_count_; lane < packet_size; ++lane) residual_rays_[lane].t_max = -1;
    for (std::size_t lane = 0; lane < residual_count_; ++lane) {
        if (residual_rays_[lane].t_max < 0) continue;
        counts_.add(RayPurpose::residual);
        hits[lane] = settings_.source.transport.tracer.closest_hit(residual_rays_[lane]);
    }
    const RadiancePacket found =
        incident_radiance(settings_.source, residual_rays_, hits, depth_ + 1, residual_streams_, counts_);
    for (std::size_t lane = 0; lane < residual_count_; ++lane)
        collect(residual_[lane], residual_rays_[lane], hits[lane], found[lane]);
    residual_count_ = 0;
}

void ResidualEstimator::collect(const ResidualRay& drawn, const Ray& ray, const Hit& hit,
                                const SplitRadiance& found) const {
    const Transport& t = settings_.source.transport;
    BrightSplit::Part bright;
    if (!is_black(found.direct)) {
        const bool coloured = !hit && t.tracer.has_coloured_panes();  // what arrives is not what shines
        bright =
            hit ? settings_.split.of_emission(ray, hit)
                : settings_.split.of_environment(
                    ray.direction, coloured ? t.lights.environment_radiance(ray.direction) : found.direct);
    }
    const Spectrum colour = !hit && t.tracer.has_coloured_panes() ? t.tracer.tint(ray, hit.t) : Spectrum{1};
    const bool true_dim = hit || drawn.exact || ray.t_max < 0;
    const Spectrum dim =
        true_dim ? found.direct * (1 - bright.share) : settings_.environment.texels[drawn.texel] * colour;
    MapRadiance residual;
    residual.direct = (drawn.bsdf * dim - drawn.held.direct) / drawn.density;
    const bool brightly = hit && !is_black(found.indirect) && settings_.split.reflects_brightly(ray, hit);
    const Spectrum dim_indirect = brightly ? Spectrum{} : found.indirect;
    residual.indirect = (drawn.bsdf * dim_indirect - drawn.held.indirect) / drawn.density;
    if (brightly && drawn.bsdf_density > 0)
        residual.indirect +=
            drawn.bsdf * found.indirect
            * (mis_weight(drawn.usual_bsdf_density, drawn.cone_density) / drawn.bsdf_density);
    FoundResidual& sum = *drawn.sum;
    sum.dim.direct += residual.direct;
    sum.dim.indirect += residual.indirect;
    sum.noise.count(drawn.second_half, luminance(residual.direct + residual.indirect));
    if (!(bright.share > 0 && drawn.bsdf_density > 0)) return;
    const Spectrum shining =
        drawn.bsdf * found.direct
        * (bright.share * mis_weight(drawn.usual_bsdf_density, drawn.light_budget * bright.pdf)
           / drawn.bsdf_density);
    const Spectrum mirrored = shining * drawn.mirrors, rest = shining - mirrored;
    sum.bright.radiance += rest;
    sum.bright.mirrored += mirrored;
    sum.bright.noise.count(drawn.second_half, luminance(rest));
    sum.bright.mirrored_noise.count(drawn.second_half, luminance(mirrored));
}

void ResidualEstimator::add_light_sample(const ShadingPoint& x, const Mirroring& mirroring,
                                         const SampleStream& stream, float rays, FoundLight& sum) {
    add_light_ray(
        x, stream, {rays, light_budget_, usual_bsdf_rays()},
        [&](WorldDir w_in) { return value_towards(x.vertex, w_in); },
        [&](WorldDir w_in, Spectrum value) { return mirroring.share(w_in, value); }, sum);
}

template <typename Reflect, typename Mirrors>
void ResidualEstimator::add_light_ray(const ShadingPoint& x, const SampleStream& stream,
                                      const LightDensities& drawn, const Reflect& reflect,
                                      const Mirrors& mirrors, FoundLight& sum) {
    const Vertex& vertex = x.vertex;
    const std::uint32_t depth = x.path.depth;
    const auto light =
        settings_.split.lights().sample(vertex.point.position, stream.next2(Dim::light_point, depth));
    if (!light || !(light->pdf > 0)) return;
    const BsdfValue bsdf = reflect(light->w_in);
    const Spectrum radiance = bsdf.value * light->radiance * settings_.split.share(*light);
    if (is_black(radiance)) return;
    const float weight = mis_weight(drawn.weighed * light->pdf, drawn.bsdf_rays * bsdf.pdf);
    light_[light_count_] = {&sum, in_second_half(stream), radiance * (weight / (drawn.rays * light->pdf)),
                            mirrors(light->w_in, bsdf.value)};
    light_rays_[light_count_++] = shadow_ray(vertex.point, *light, stream.bits(Dim::opacity, 2 * depth + 1));
    if (light_count_ == packet_size) trace_light();
}

void ResidualEstimator::add_lobes(const LobePoint& point, SampledRadiance& sum) {
    const float light_rays = settings_.budget.light > 0 && !settings_.split.empty() ? point.rays : 0;
    FoundResidual& met = sum.residual;
    for_each_ray(point.rays, point.stream, lobe_purpose, met.noise,
                 [&](const SampleStream& stream) { add_lobe_ray(point, light_rays, stream, met); });
    met.bright.noise.rays = met.noise.rays;
    if (!(light_rays > 0)) return;
    for_each_ray(light_rays, point.stream, lobe_light_purpose, sum.light.noise,
                 [&](const SampleStream& stream) { add_lobe_light(point, stream, sum.light); });
}

void ResidualEstimator::add_lobe_ray(const LobePoint& point, float light_rays, const SampleStream& stream,
                                     FoundResidual& sum) {
    const ShadingPoint& x = point.x;
    wait_for(x.path.depth);
    const std::optional<WorldDir> direction = draw_from(point.lobes.drawn, x, stream);
    if (!direction) return;
    const BsdfValue bsdf = value_towards(point, *direction);
    const float density = point.rays * bsdf.pdf;
    if (is_black(bsdf.value) || !(density > 0)) return;
    const std::size_t lane = residual_count_++;
    residual_[lane] = {&sum,       in_second_half(stream),
                       0,          bsdf.value,
                       0,          {},  // nothing is held
                       density,    density,
                       density,    0,
                       light_rays, true};
    residual_streams_[lane] = stream;
    residual_rays_[lane] = {ray_origin(x.vertex.point, *direction), *direction, infinity,
                            stream.bits(Dim::opacity, 2 * x.path.depth + 2)};
    if (residual_count_ == packet_size) trace_residual();
}

void ResidualEstimator::add_lobe_light(const LobePoint& point, const SampleStream& stream, FoundLight& sum) {
    add_light_ray(
        point.x, stream, {point.rays, point.rays, point.rays},
        [&](WorldDir w_in) { return value_towards(point, w_in); },
        [](WorldDir, Spectrum) { return 0.0f; },  // all of this is apart
        sum);
}

void ResidualEstimator::trace_light() {
    if (light_count_ == 0) return;
    for (std::size_t lane = light_count_; lane < packet_size; ++lane) light_rays_[lane].t_max = -1;
    std::array<Spectrum, packet_size> passed;
    counts_.add(RayPurpose::shadow, light_count_);
    settings_.source.transport.tracer.passed_light(light_rays_, passed);
    for (std::size_t lane = 0; lane < light_count_; ++lane) {
        const LightRay& ray = light_[lane];
        const Spectrum found = ray.reflected * passed[lane], mirrored = found * ray.mirrors,
                       rest = found - mirrored;
        ray.sum->radiance += rest;
        ray.sum->mirrored += mirrored;
        ray.sum->noise.count(ray.second_half, luminance(rest));
        ray.sum->mirrored_noise.count(ray.second_half, luminance(mirrored));
    }
    light_count_ = 0;
}

void ResidualEstimator::add_cone(const ShadingPoint& x, const SampleStream& stream, FoundCones& sum) {
    const Vertex& vertex = x.vertex;
    const std::uint32_t depth = x.path.depth;
    const ConeSample drawn = sample(cones_, stream.next2(Dim::direction, depth));
    const BsdfValue bsdf = value_towards(vertex, drawn.direction);
    if (is_black(bsdf.value)) return;
    if (cone_count_ > 0 && depth != cone_depth_) trace_cones();
    cone_depth_ = depth;
    const float density = cone_budget_ * drawn.pdf;
    const float bsdf_density = usual_bsdf_rays() * bsdf.pdf;
    cone_[cone_count_] = {&sum, in_second_half(stream),
                          bsdf.value * (mis_weight(density, bsdf_density) / density)};
    cone_streams_[cone_count_] = stream;
    cone_rays_[cone_count_++] = {ray_origin(vertex.point, drawn.direction), drawn.direction, infinity,
                                 stream.bits(Dim::opacity, 2 * depth + 2)};
    if (cone_count_ == packet_size) trace_cones();
}

void ResidualEstimator::trace_cones() {
    if (cone_count_ == 0) return;
    std::array<Hit, packet_size> hits;
    for (std::size_t lane = cone_count_; lane < packet_size; ++lane) cone_rays_[lane].t_max = -1;
    counts_.add(RayPurpose::residual, cone_count_);
    settings_.source.transport.tracer.closest_hits(cone_rays_, hits, Coherence::incoherent);
    for (std::size_t lane = 0; lane < cone_count_; ++lane)
        if (!hits[lane] || !settings_.split.reflects_brightly(cone_rays_[lane], hits[lane]))
            cone_rays_[lane].t_max = -1;
    const RadiancePacket found =
        incident_radiance(settings_.source, cone_rays_, hits, cone_depth_ + 1, cone_streams_, counts_);
    for (std::size_t lane = 0; lane < cone_count_; ++lane) {
        if (cone_rays_[lane].t_max < 0) continue;
        const Spectrum reflected = cone_[lane].weight * found[lane].indirect;
        cone_[lane].sum->indirect += reflected;
        cone_[lane].sum->noise.count(cone_[lane].second_half, luminance(reflected));
    }
    cone_count_ = 0;
}

}  // namespace relumine
