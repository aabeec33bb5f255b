// SPDX-License-Identifier: Apache-2.0
// Pilot light samples, then quad by quad of pixels map integrals and residual rays.
#include "integrators/cell_light.hpp"

#include "integrators/shared_integral.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

/// Pixels along each side of the squares whose samples may share an integral, if no map around is of a
/// smaller block than the second. Weights of maps change there from pixel to pixel: a level takes care of it.
constexpr int quad_pixels = 4;
constexpr float quad_shares = 16;

/// Lobes that are sharper get at least so many residual rays per pixel, and draw so many of them.
constexpr float sharp_alpha = 0.15f, sharp_rays = 8, sharp_bsdf_share = 0.5f;

/// √ of the samples of this pass over all of the picture's: the whole errs less than a pass by as much.
float pass_share(std::size_t samples, float all) {
    return std::sqrt(std::min(1.0f, static_cast<float>(samples) / all));
}

class CellLight {
  public:
    CellLight(const CellLightSource& source, std::span<const BlockMap* const> maps, LitCell& cell,
              RayCounts& rays, CacheCounts& counts)
        : source_(source),
          plan_(source.plan),
          maps_(maps),
          cell_(cell),
          estimator_(source.residual, rays),
          shared_({source.grid, source.points, source.residual.environment, source.plan.exact},
                  {source.estimates_noise, source.plan.rays.residual > 0}),
          rays_(rays),
          counts_(counts) {}

    /// The light of lights without size on all samples, and the first samples of the others.
    void add_pilot(const CellRow& row) {
        const StepTimer timer(counts_, CacheStep::product);
        for (int y = cell_.rect.y0; y < cell_.rect.y1; ++y)
            for (int x = cell_.rect.x0; x < cell_.rect.x1; ++x)
                for (std::size_t s = 0; s < cell_.per_pixel; ++s) {
                    LitSample& sample = cell_.at(x, y)[s];
                    sample.pixel = &row.samples[s]->at(x, y);
                    if (sample.pixel->point) add_pilot(sample);
                }
        estimator_.finish();
        for (std::size_t i = 0; i < cell_.samples.size(); ++i)
            if (const LitSample& sample = cell_.samples[i]; sample.pixel->reflects_alone)
                cell_.pilots[i / cell_.per_pixel].add(sample.sampled.light,
                                                      luminance(sample.pixel->point->path.throughput));
    }

    /// Map integrals and residual rays; what those find is there at the end.
    void add_maps() {
        for_each_quad([&](const PixelRect& quad) { light_quad(quad); });
        const StepTimer timer(counts_, CacheStep::product);
        estimator_.finish();
        for (LitSample& sample : cell_.samples) sample.sampled.light.join(sample.more_light);
    }

    /// More residual rays where the first ones scatter by more than is wanted.
    void add_more() {
        if (!plan_.demand.residual_adapts || !(plan_.rays.residual > 0)) return;
        demand_more();
        for_each_quad([&](const PixelRect& quad) {
            if (wants_more(quad)) light_quad(quad);
        });
        const StepTimer timer(counts_, CacheStep::product);
        estimator_.finish();
        for (LitSample& sample : cell_.samples) sample.sampled.residual.join(sample.more_residual);
    }

  private:
    template <typename Use>
    void for_each_quad(const Use& use) {
        for (int y = cell_.rect.y0; y < cell_.rect.y1; y += quad_pixels)
            for (int x = cell_.rect.x0; x < cell_.rect.x1; x += quad_pixels)
                use(intersection({x, y, x + quad_pixels, y + quad_pixels}, cell_.rect));
    }

    /// What is asked for by what the first residual rays have found.
    void demand_more() {
        const StepTimer timer(counts_, CacheStep::product);
        const std::vector<PilotResidual> pilots = residual_pilots();
        const ResidualScatter scatter(pilots);
        for (const PilotResidual& pilot : pilots)
            more_.push_back(pilot.samples > 0 ? more_rays(pilot, scatter.without(pilot)) : 0);
        for (LitSample& sample : cell_.samples) sample.done = !has_residual(sample);
    }

    static bool has_residual(const LitSample& sample) { return sample.sampled.residual.bright.rays > 0; }

    [[nodiscard]] std::vector<PilotResidual> residual_pilots() const {
        std::vector<PilotResidual> pilots(cell_.pilots.size());
        for (std::size_t i = 0; i < cell_.samples.size(); ++i) {
            const LitSample& sample = cell_.samples[i];
            if (has_residual(sample))
                pilots[i / cell_.per_pixel].add(sample.sampled.residual, deviation_of_one * sample.deviation,
                                                *sample.pixel->point);
        }
        return pilots;
    }

    /// Beside the first, for each sample of a pixel.
    [[nodiscard]] float more_rays(const PilotResidual& pilot, float scatter) const {
        const float before = pilot.rays * plan_.pixel_samples / pilot.samples;
        return RayDemand::more_residual(scatter, before) / plan_.pixel_samples;
    }

    [[nodiscard]] float more(int x, int y) const {
        return more_[static_cast<std::size_t>((y - cell_.rect.y0) * cell_.rect.width() + x - cell_.rect.x0)];
    }

    [[nodiscard]] bool wants_more(const PixelRect& quad) const {
        for (int y = quad.y0; y < quad.y1; ++y)
            for (int x = quad.x0; x < quad.x1; ++x)
                if (more(x, y) > 0) return true;
        return false;
    }

    [[nodiscard]] bool in_second_series() const { return !more_.empty(); }

    void add_pilot(LitSample& sample) {
        const ShadingPoint& point = *sample.pixel->point;
        sample.delta = delta_light(source_.transport, point.vertex,
                                   sample.pixel->stream.bits(Dim::opacity, 2 * point.path.depth + 1), rays_);
        if (!sample.pixel->reflects_alone) return;
        const auto lobes = sharp_lobes(point.vertex.bsdf, plan_.sharp_alpha);
        if (!lobes) {
            add_first_light(point, sample);
            return;
        }
        sample.lobes = &cell_.lobes.emplace_back();
        add_first_light(without(*lobes, point), sample);
    }

    /// `point`: the sample's, as maps know it.
    void add_first_light(const ShadingPoint& point, LitSample& sample) {
        sample.bsdf = *receiver_bsdf(point.vertex, map_frame);
        const RayDemand& demand = plan_.demand;
        const float rays = demand.light_adapts ? demand.pilot / plan_.pixel_samples : plan_.rays.light;
        estimator_.add_light(point, sample.pixel->stream, rays, RaySeries::first, sample.sampled.light);
    }

    static ShadingPoint without(const SharpLobes& lobes, ShadingPoint point) {
        point.vertex.bsdf = lobes.rest;
        return point;
    }

    /// Samples of a pixel that see the same surface alike share an integral, and so do those of the quad's
    /// pixels where maps are large.
    void light_quad(const PixelRect& quad) {
        for (int y = quad.y0; y < quad.y1; ++y)
            for (int x = quad.x0; x < quad.x1; ++x)
                for (LitSample& first : cell_.at(x, y)) {
                    if (!waits(first)) continue;
                    if (has_nothing_but_lobes(first)) {
                        first.done = true;
                        light_lobes(first);
                        continue;
                    }
                    const Blend blend = blend_of(first);
                    if (blend.empty()) {
                        gather(first);
                        continue;
                    }
                    const bool stands_alone = blend.smallest_block() < quad_shares;
                    if (in_second_series() && stands_alone && !(more(x, y) > 0)) {
                        leave_own(x, y, first);
                        continue;
                    }
                    integrate(first, blend);
                    const StepTimer timer(counts_, CacheStep::product);
                    light_own(x, y);
                    if (!stands_alone) light_others(quad, x, y);
                }
    }

    [[nodiscard]] Blend blend_of(const LitSample& sample) const {
        Blend blend = blend_maps(sample.pixel->cache, maps_);
        if (!plan_.blends) blend.keep_heaviest();
        return blend;
    }

    void gather(LitSample& sample) {
        sample.reflected = source_.monte_carlo.reflected(*sample.pixel->point, sample.pixel->stream, rays_);
        sample.sampled = {};
        sample.lobes = nullptr;
        sample.done = true;
        ++counts_.gathered;
    }

    void integrate(const LitSample& first, const Blend& blend) {
        const StepTimer timer(counts_, CacheStep::shade);
        shared_.run(first, blend);
    }

    /// The pixels of the quad behind (x, y).
    void light_others(const PixelRect& quad, int x, int y) {
        for (int other_y = y; other_y < quad.y1; ++other_y)
            for (int other_x = other_y == y ? x + 1 : quad.x0; other_x < quad.x1; ++other_x)
                light_other(other_x, other_y);
    }

    /// Lights the samples of a pixel that may share the integral of one of them.
    void light_own(int x, int y) {
        const LitSample& first = shared_.first();
        light_those(x, y, 1, [&](const LitSample& sample) {
            return &sample == &first || shares_integral(first, sample, plan_.exact);
        });
    }

    /// As those would be lit, but for light: those behind must meet the same integrals again.
    void leave_own(int x, int y, const LitSample& first) {
        for (LitSample& sample : cell_.at(x, y))
            if (waits(sample) && (&sample == &first || shares_integral(first, sample, plan_.exact)))
                sample.done = true;
    }

    /// Lights the samples of a pixel that may share the integral of one of another pixel.
    void light_other(int x, int y) {
        const LitSample& first = shared_.first();
        const auto alike = [&](const LitSample& sample) {
            return shares_integral(first, sample, plan_.exact) && seen_alike(first, sample);
        };
        for (const LitSample& sample : cell_.at(x, y)) {
            if (!waits(sample) || !alike(sample)) continue;
            const Blend blend = blend_of(sample);
            if (blend.smallest_block() >= quad_shares && !blend.empty())
                light_those(x, y, shared_.level_under(blend), alike);
            return;
        }
    }

    template <typename Which>
    void light_those(int x, int y, float level, const Which& which) {
        std::optional<RayBudget> budget;
        for (LitSample& sample : cell_.at(x, y)) {
            if (!waits(sample) || !which(sample)) continue;
            if (in_second_series()) {
                light_more(sample, level, more(x, y));
                continue;
            }
            if (!budget) budget = budget_of(sample, cell_.expected(x, y));
            light(sample, level, *budget);
        }
    }

    static bool waits(const LitSample& sample) { return sample.pixel->reflects_alone && !sample.done; }

    void light(LitSample& sample, float level, const RayBudget& budget) {
        sample.done = true;
        ++counts_.points;
        const Spectrum scale = shared_.give(level, sample);
        const ShadingPoint& point = *sample.pixel->point;
        if (!sample.lobes) {
            add_rays(point, sample, scale, level, budget);
            return;
        }
        const SharpLobes lobes = *sharp_lobes(point.vertex.bsdf, plan_.sharp_alpha);
        add_rays(without(lobes, point), sample, scale, level, budget);
        add_lobes(lobes, sample);
    }

    /// By the same integral again, since the same samples are lit in the same order.
    void light_more(LitSample& sample, float level, float rays) {
        sample.done = true;
        if (!(rays > 0)) return;
        const Spectrum scale = shared_.give(level, sample);
        ShadingPoint point = *sample.pixel->point;
        if (sample.lobes) point = without(*sharp_lobes(point.vertex.bsdf, plan_.sharp_alpha), point);
        add_residual(point, sample, scale, level, rays, RaySeries::second, sample.more_residual);
    }

    /// `point`: the sample's, without sharp lobes; `scale`, `level`: of its integral and radiance, against
    /// those shared.
    void add_rays(const ShadingPoint& point, LitSample& sample, Spectrum scale, float level,
                  const RayBudget& budget) {
        const SampleStream& stream = sample.pixel->stream;
        add_residual(point, sample, scale, level, budget.residual, RaySeries::first, sample.sampled.residual);
        estimator_.add_cones(point, stream, sample.sampled.cones);
        estimator_.add_light(point, stream, budget.light, RaySeries::second, sample.more_light);
    }

    void add_residual(const ShadingPoint& point, const LitSample& sample, Spectrum scale, float level,
                      float rays, RaySeries series, FoundResidual& sum) {
        estimator_.add({point, sample.pixel->stream, shared_.integral(), shared_.distribution(), scale, level,
                        rays, meets_lights(sample) ? sharp_bsdf_share : usual_bsdf_share, plan_.exact},
                       series, sum);
    }

    static bool has_nothing_but_lobes(const LitSample& sample) {
        return sample.lobes && !has_layers(sample.bsdf) && is_black(sample.bsdf.diffuse);
    }

    void light_lobes(LitSample& sample) {
        const StepTimer timer(counts_, CacheStep::product);
        ++counts_.points;
        add_lobes(*sharp_lobes(sample.pixel->point->vertex.bsdf, plan_.sharp_alpha), sample);
    }

    void add_lobes(const SharpLobes& lobes, LitSample& sample) {
        estimator_.add_lobes({*sample.pixel->point, sample.pixel->stream, lobes, plan_.lobe_rays},
                             *sample.lobes);
    }

    /// As many rays as the expected error of the sample's pixel asks for. Nothing that they are to find may
    /// count.
    [[nodiscard]] RayBudget budget_of(const LitSample& sample, const ExpectedLight& bright) const {
        const RayDemand& demand = plan_.demand;
        const float sharp =
            demand.residual_adapts && meets_lights(sample) ? sharp_rays / plan_.pixel_samples : 0.0f;
        const MapRadiance held = shared_.integral().reflected();
        const float throughput = luminance(sample.pixel->point->path.throughput);
        const float shines = luminance(sample.pixel->emission)
                             + throughput * luminance(held.direct + held.indirect + sample.delta)
                             + bright.mean;
        RayBudget budget{std::max(plan_.rays.residual, sharp), 0};
        if (!(shines > 0)) return budget;
        if (demand.residual_adapts && plan_.rays.residual > 0)
            budget.residual = std::max(
                demand.residual_rays(throughput * shared_.deviation() / shines) / plan_.pixel_samples, sharp);
        if (!demand.light_adapts) return budget;
        const float deviation = bright.deviation * pass_share(cell_.per_pixel, plan_.pixel_samples);
        budget.light =
            bright.known ? demand.more_light(deviation / shines) / plan_.pixel_samples : plan_.rays.light;
        return budget;
    }

    /// Whether bright light may be left to rays that the BSDF draws: lobes so sharp are not worth light
    /// samples, and nothing else asks for rays where one is filled by a lamp.
    [[nodiscard]] bool meets_lights(const LitSample& sample) const {
        return sharpest_alpha(sample.bsdf) < sharp_alpha && !source_.residual.split.empty();
    }

    const CellLightSource& source_;
    const CachePlan& plan_;
    std::span<const BlockMap* const> maps_;
    LitCell& cell_;
    ResidualEstimator estimator_;
    SharedIntegral shared_;
    RayCounts& rays_;
    CacheCounts& counts_;
    std::vector<float> more_;  // residual rays of the second series, by pixel
};

LitCell dark_cell(const CellRow& row, const PixelRect& rect) {
    const auto pixels = static_cast<std::size_t>(rect.width()) * static_cast<std::size_t>(rect.height());
    LitCell cell{rect, row.samples.size(), {}, std::vector<PilotLight>(pixels), {}};
    cell.samples.resize(pixels * cell.per_pixel);
    return cell;
}

}  // namespace

LitCell light_cell(const CellLightSource& source, const CellRow& row, const PixelRect& rect,
                   std::span<const BlockMap* const> maps, RayCounts& rays, CacheCounts& counts) {
    LitCell cell = dark_cell(row, rect);
    CellLight light(source, maps, cell, rays, counts);
    light.add_pilot(row);
    light.add_maps();
    light.add_more();
    return cell;
}

}  // namespace relumine
