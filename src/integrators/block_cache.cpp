// SPDX-License-Identifier: Apache-2.0
// The pipeline of `cache`, row of cells by row of cells: camera hits, records, maps, integrals, residual
// rays; then the filter over what the residual rays have found.
#include "integrators/block_cache.hpp"

#include <mutex>

#include "base/executor.hpp"
#include "base/pixel_rect.hpp"
#include "blocks/dim_environment.hpp"
#include "integrators/cell_rows.hpp"
#include "integrators/gather_estimate.hpp"
#include "integrators/light_source.hpp"
#include "integrators/lit_sample.hpp"
#include "integrators/path_tracer.hpp"
#include "integrators/residual_film.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t samples_per_pass = 16;  // that share maps

/// Radiance over which light is bright, and below which relative errors do not matter, against the
/// environment's mean.
constexpr float bright_factor = 128, least_level = 0.05f;

/// Of a record, about.
constexpr std::uint64_t usual_record_bytes = 55'000;

/// Lobes that are sharper get at least so many residual rays per pixel, and draw so many of them.
constexpr float sharp_alpha = 0.15f, sharp_rays = 8, sharp_bsdf_share = 0.5f;

/// The integral does not resolve lobes that are sharper: 2 α radians are less than three of its points.
constexpr float unresolved_alpha = 0.02f;

/// Texels along each side of the world's square.
constexpr int grid_side = 64;

/// A thread's memory for one pixel after the other.
struct Workspace {
    MapIntegral integral;
    MapIntegral matte;  // of its diffuse part, if has_matte
    bool has_matte = false;
    ResidualDistribution distribution;
};

class BlockCache final : public Integrator {
  public:
    BlockCache(const RenderSettings& settings, const CachePlan& plan, const Transport& transport,
               const View& view, bool surface_layers)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          plan_(plan),
          found_(plan.filters, std::ranges::find(settings.aovs, "error") != settings.aovs.end()),
          max_depth_(depth_limit(settings)),
          source_(incident_source(settings, transport)),
          map_source_(source_),
          monte_carlo_(settings, transport, view),
          split_(transport.scene, bright_factor, plan.rays.light > 0 ? transport.field : nullptr),
          grid_(grid_side),
          points_(grid_),
          environment_(transport, split_, grid_, resolve_threads(settings.threads)) {
        map_source_.field = transport.field;  // maps may err: residual rays know
        plan_.blocks.level = least_level * environment_.luminance;
    }

    [[nodiscard]] std::uint32_t shortest_pass() const override { return samples_per_pass; }
    [[nodiscard]] std::uint32_t longest_pass() const override { return samples_per_pass; }

    [[nodiscard]] bool works_in_preparation() const override { return true; }
    [[nodiscard]] std::uint64_t known_bytes() const override {  // of records and maps the least
        const auto row =
            static_cast<std::size_t>(std::min(view_.window.width() + 5 * cell_pixels, view_.width));
        return count(region()) * (sizeof(PixelSums) + found_.bytes_per_pixel())
               + 3 * row * cell_pixels * samples_per_pass * sizeof(GBufferPixel) + least_bytes();
    }
    void keep_within(std::uint64_t bytes) override {
        plan_.blocks.map_weight = double{CellRows::with_maps} / double{CellRows::most};
        plan_.blocks.most_bytes = static_cast<double>(bytes + least_bytes()) / static_cast<double>(cells())
                                  / double{CellRows::most};
    }

    void prepare(Preparation& p) override {
        region_ = region();
        pixels_.assign(count(region_), {});
        found_.begin(region_.width(), region_.height());
        constexpr int margin = CellRows::reach * cell_pixels;
        const MapSource maps{map_source_, split_, grid_, environment_};
        CellRows rows({transport_, view_, surface_layers_, max_depth_, maps}, plan_, region_);
        for (int y = region_.y0 - margin; y < region_.y1 + margin && !p.stop(); y += cell_pixels) {
            rows.take_in(y, p);
            if (!rows.ready()) continue;
            light_row(rows, p);
            rows.release();
            if (p.progress) p.progress(static_cast<double>(y - cell_pixels - region_.y0) / region_.height());
        }
        // After a stop, too: what is lit may be all there is to show.
        found_.add_to(pixels_, plan_.exact, !split_.empty(), p.threads);
    }

    void render(Tile& tile) const override {
        for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
            for (int x = tile.rect.x0; x < tile.rect.x1; ++x)
                tile.pixels[static_cast<std::size_t>(y - tile.rect.y0)
                                * static_cast<std::size_t>(tile.rect.width())
                            + static_cast<std::size_t>(x - tile.rect.x0)] = pixels_[index_of(x, y)];
    }

  private:
    static std::size_t count(const PixelRect& r) {
        return static_cast<std::size_t>(r.width()) * static_cast<std::size_t>(r.height());
    }
    /// What a pass computes: the window, and what its filter reaches.
    [[nodiscard]] PixelRect region() const {
        return intersection(aligned(grown(view_.window, found_.reach()), cell_pixels),
                            {0, 0, view_.width, view_.height});
    }
    /// Of a row.
    [[nodiscard]] std::uint64_t cells() const {
        const int width = std::min(region().width() + 2 * CellRows::reach * cell_pixels, view_.width);
        return static_cast<std::uint64_t>((width + cell_pixels - 1) / cell_pixels + 1);
    }
    /// Room for two records and maps in each cell: with less, many samples would have none.
    [[nodiscard]] std::uint64_t least_bytes() const {
        return 2 * cells()
               * (CellRows::with_maps * BlockMap::bytes(grid_, map_source_.reflects())
                  + CellRows::most * usual_record_bytes);
    }
    [[nodiscard]] std::size_t index_of(int x, int y) const {
        return static_cast<std::size_t>(y - region_.y0) * static_cast<std::size_t>(region_.width())
               + static_cast<std::size_t>(x - region_.x0);
    }

    /// Lights the row that is ready.
    void light_row(const CellRows& rows, Preparation& p) {
        const CellRow& here = *rows.ready();
        std::mutex mutex;
        parallel_for(p.threads, here.cells(), [&](std::size_t i) {
            const PixelRect cell = intersection(here.cell(i), region_);
            if (cell.x0 >= cell.x1 || p.stop()) return;
            const std::vector<const BlockMap*> candidates = rows.maps_around(i);
            const MapIntegral integral(grid_, points_, environment_, plan_.exact);
            Workspace workspace{integral, integral, false, ResidualDistribution(grid_)};
            RayCounts rays;
            CacheCounts counts;
            WorkDone dropped;
            LitCell lit = begin_cell(here, cell, rays, counts);
            for (int y = cell.y0; y < cell.y1; ++y)
                for (int x = cell.x0; x < cell.x1; ++x) {
                    Tile sums = make_tile({x, y, x + 1, y + 1}, 0, 0);
                    sums.probe = p.probe;
                    light_pixel(here, candidates, lit, workspace, sums, rays, counts);
                    if (contains(view_.window, x, y)) dropped.add(sums.non_finite, sums.first_non_finite);
                }
            const std::lock_guard lock(mutex);
            p.rays.add(rays);
            p.counts.add(counts);
            p.dropped.add(dropped.non_finite, dropped.first_non_finite);
        });
    }

    /// The light of lights without size on all samples of a cell, and the first samples of the others.
    LitCell begin_cell(const CellRow& row, const PixelRect& rect, RayCounts& rays,
                       CacheCounts& counts) const {
        const StepTimer timer(counts, CacheStep::product);
        LitCell cell{rect, row.samples.size(), {}, std::vector<PilotLight>(count(rect))};
        cell.samples.resize(count(rect) * cell.per_pixel);
        const ResidualSettings settings = residual_settings();
        ResidualEstimator estimator(settings, rays);
        const float pilot =
            plan_.demand.light_adapts ? plan_.demand.pilot / plan_.pixel_samples : plan_.rays.light;
        for (int y = rect.y0; y < rect.y1; ++y)
            for (int x = rect.x0; x < rect.x1; ++x)
                for (std::size_t s = 0; s < cell.per_pixel; ++s) {
                    LitSample& sample = cell.at(x, y)[s];
                    sample.pixel = &row.samples[s]->at(x, y);
                    if (!sample.pixel->point) continue;
                    const ShadingPoint& point = *sample.pixel->point;
                    sample.delta =
                        delta_light(transport_, point.vertex,
                                    sample.pixel->stream.bits(Dim::opacity, 2 * point.path.depth + 1), rays);
                    if (!sample.pixel->reflects_alone) continue;
                    sample.bsdf = *receiver_bsdf(point.vertex, map_frame);
                    leave_lobe_to_rays(sample);
                    estimator.add_light(point, sample.pixel->stream, pilot, LightSeries::first,
                                        sample.sampled.light);
                }
        estimator.finish();
        for (std::size_t i = 0; i < cell.samples.size(); ++i)
            if (const LitSample& sample = cell.samples[i]; sample.pixel->reflects_alone)
                cell.pilots[i / cell.per_pixel].add(sample.sampled.light,
                                                    luminance(sample.pixel->point->path.throughput));
        return cell;
    }

    [[nodiscard]] ResidualSettings residual_settings() const {
        return {source_, split_, environment_, plan_.rays};
    }

    /// `sums`: of the pixel, empty.
    void light_pixel(const CellRow& row, std::span<const BlockMap* const> candidates, LitCell& cell,
                     Workspace& w, Tile& sums, RayCounts& rays, CacheCounts& counts) {
        const int x = sums.rect.x0, y = sums.rect.y0;
        const std::span<LitSample> samples = cell.at(x, y);
        light_from_maps(candidates, samples, cell.expected(x, y), w, rays, counts);
        PixelResidual residual;
        DoubtSum doubt;
        for (const LitSample& sample : samples) finish_sample(sample, sums, residual, doubt, rays);
        pixels_[index_of(x, y)] = sums.pixels[0];
        if (found_.estimates_noise())
            found_.put(index_of(x, y), residual, doubt.finish(), guide_of(row, x, y));
    }

    /// Map integrals and residual rays of a pixel's samples. Samples that see the same surface alike share an
    /// integral.
    void light_from_maps(std::span<const BlockMap* const> candidates, std::span<LitSample> samples,
                         const ExpectedLight& bright, Workspace& w, RayCounts& rays,
                         CacheCounts& counts) const {
        const ResidualSettings settings = residual_settings();
        ResidualEstimator estimator(settings, rays);
        std::vector<FoundLight> more(samples.size());
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const LitSample& first = samples[i];
            if (!first.pixel->reflects_alone || first.done) continue;
            const Blend blend = blend_maps(first.pixel->cache, candidates);
            if (blend.empty()) {
                samples[i].reflected = monte_carlo_.reflected(*first.pixel->point, first.pixel->stream, rays);
                samples[i].sampled = {};
                ++counts.gathered;
                continue;
            }
            integrate(first, blend, w, counts);
            const RayBudget budget =
                budget_of(first, bright, w, pass_share(samples.size(), plan_.pixel_samples));
            const StepTimer timer(counts, CacheStep::product);
            for (std::size_t j = i; j < samples.size(); ++j) {
                LitSample& sample = samples[j];
                if (!sample.pixel->reflects_alone || sample.done
                    || (j != i && !shares_integral(first, sample, plan_.exact || first.lobe_by_rays)))
                    continue;
                sample.done = true;
                sample.maps = static_cast<float>(blend.maps().size());
                const Spectrum scale = diffuse_ratio(first, sample);
                take_reflected(first, blend, scale, w, sample);
                if (sample.lobe_by_rays) sample.albedo += sample.bsdf.specular_f0;
                if (found_.estimates_noise()) sample.deviation = luminance(scale) * w.integral.deviation();
                ++counts.points;
                estimator.add({*sample.pixel->point, sample.pixel->stream, w.integral, w.distribution,
                               has_layers(first.bsdf) ? Spectrum{1} : scale, budget.residual,
                               meets_lights(first) ? sharp_bsdf_share : usual_bsdf_share,
                               plan_.exact || first.lobe_by_rays},
                              sample.sampled);
                estimator.add_light(*sample.pixel->point, sample.pixel->stream, budget.light,
                                    LightSeries::second, more[j]);
            }
            estimator.finish();
        }
        for (std::size_t i = 0; i < samples.size(); ++i) samples[i].sampled.light.join(more[i]);
    }

    /// √ of the samples of this pass over all of the picture's: the whole errs less than a pass by as much.
    [[nodiscard]] static float pass_share(std::size_t samples, float all) {
        return std::sqrt(std::min(1.0f, static_cast<float>(samples) / all));
    }

    /// Rays for a sample with the integral in `w`: as many as its expected error asks for. Nothing that they
    /// are to find may count.
    [[nodiscard]] RayBudget budget_of(const LitSample& sample, const ExpectedLight& bright,
                                      const Workspace& w, float pass_share) const {
        const RayDemand& demand = plan_.demand;
        const float sharp = !demand.residual_adapts || !meets_lights(sample) ? 0.0f
                            : sample.lobe_by_rays                            ? 1.0f
                                                  : sharp_rays / plan_.pixel_samples;
        const MapRadiance held = w.integral.reflected();
        const float throughput = luminance(sample.pixel->point->path.throughput);
        const float shines = luminance(sample.pixel->emission)
                             + throughput * luminance(held.direct + held.indirect + sample.delta)
                             + bright.mean;
        if (!(shines > 0)) return {std::max(plan_.rays.residual, sharp), 0};
        RayBudget budget{plan_.rays.residual, 0};
        if (demand.residual_adapts && plan_.rays.residual > 0)
            budget.residual =
                demand.residual_rays(throughput * w.integral.deviation() / shines) / plan_.pixel_samples;
        budget.residual = std::max(budget.residual, sharp);
        if (demand.light_adapts)
            budget.light =
                bright.known ? demand.more_light(bright.deviation * pass_share / shines) / plan_.pixel_samples
                             : plan_.rays.light;
        return budget;
    }

    /// Whether bright light may be left to rays that the BSDF draws: lobes so sharp are not worth light
    /// samples, and nothing else asks for rays where one is filled by a lamp.
    [[nodiscard]] bool meets_lights(const LitSample& sample) const {
        if (sample.lobe_by_rays) return true;
        return sample.bsdf.specular && sample.bsdf.ggx.alpha < sharp_alpha && !split_.empty();
    }

    /// A lobe that is too sharp for the maps' texels is none of theirs.
    void leave_lobe_to_rays(LitSample& sample) const {
        if (plan_.rays.residual <= 0 || !sample.bsdf.specular || sample.bsdf.ggx.alpha >= unresolved_alpha)
            return;
        sample.bsdf.specular = false;
        sample.lobe_by_rays = true;
    }

    void integrate(const LitSample& sample, const Blend& blend, Workspace& w, CacheCounts& counts) const {
        const StepTimer timer(counts, CacheStep::shade);
        w.integral.run(blend, sample.bsdf, sample.pixel->cache.gather.frame.n);
        w.has_matte = false;
        if (plan_.rays.residual > 0 || found_.estimates_noise()) w.integral.estimate_deviations();
        if (plan_.rays.residual > 0) w.distribution.build(w.integral);
    }

    /// The integral of `first`, its diffuse part multiplied by `scale`. Where there are layers over it, that
    /// part is another integral.
    static void take_reflected(const LitSample& first, const Blend& blend, Spectrum scale, Workspace& w,
                               LitSample& sample) {
        const MapRadiance all = w.integral.reflected();
        const auto scaled = [&](Spectrum whole, Spectrum part) {
            return whole + (scale - Spectrum{1}) * part;
        };
        if (scale == Spectrum{1}) {
            sample.reflected = {{}, all.direct, all.indirect};
            sample.albedo = w.integral.albedo();
        } else if (!has_layers(first.bsdf)) {
            sample.reflected = {{}, scale * all.direct, scale * all.indirect};
            sample.albedo = scale * w.integral.albedo();
        } else {
            if (!w.has_matte) {
                ReceiverBsdf matte = first.bsdf;
                matte.specular = false;
                w.matte.run(blend, matte, first.pixel->cache.gather.frame.n);
                w.has_matte = true;
            }
            const MapRadiance part = w.matte.reflected();
            sample.reflected = {{}, scaled(all.direct, part.direct), scaled(all.indirect, part.indirect)};
            sample.albedo = scaled(w.integral.albedo(), w.matte.albedo());
        }
    }

    /// Adds a sample with all its light; what is to be filtered goes into `residual` instead.
    void finish_sample(const LitSample& sample, Tile& sums, PixelResidual& residual, DoubtSum& doubt,
                       RayCounts& rays) const {
        const GBufferPixel& pixel = *sample.pixel;
        SplitRadiance radiance{pixel.emission, {}, {}};
        Spectrum throughput;
        SampledRadiance found;
        if (pixel.point) {
            SplitRadiance reflected = sample.reflected;
            if (!pixel.reflects_alone) reflected = monte_carlo_.reflected(*pixel.point, pixel.stream, rays);
            reflected.direct += sample.delta;
            reflected.indirect +=
                caustic_light(transport_, pixel.point->vertex, pixel.point->path.depth, max_depth_);
            throughput = pixel.point->path.throughput;
            found = finite_or_nothing(sample.sampled, rays);
            radiance.direct = throughput * reflected.direct;
            radiance.indirect = throughput * reflected.indirect;
        }
        if (found_.estimates_noise())
            doubt.add(found, throughput, radiance.total(), sample.albedo, sample.deviation);
        if (plan_.filters && !sample.lobe_by_rays) {  // what such a lobe shows is as fine as pixels
            residual.bright += throughput * (found.bright + found.light.radiance);
            residual.direct += throughput * found.residual.direct;
            residual.indirect += throughput * found.residual.indirect;
            residual.albedo += throughput * sample.albedo;
        } else {
            radiance.direct += throughput * (found.residual.direct + found.bright + found.light.radiance);
            radiance.indirect += throughput * found.residual.indirect;
        }
        CacheFigures figures;
        figures.records = sample.maps;
        sums.add(sums.rect.x0, sums.rect.y0, pixel.stream.index, radiance, pixel.surface, figures);
    }

    /// What is not finite must not spread in the filter.
    static SampledRadiance finite_or_nothing(const SampledRadiance& found, RayCounts& rays) {
        if (is_finite(found.residual.direct + found.residual.indirect + found.bright + found.light.radiance))
            return found;
        ++rays.non_finite;
        return {};
    }

    [[nodiscard]] std::uint32_t material_of(const ShadingPoint& point) const {
        return static_cast<std::uint32_t>(point.vertex.point.material - transport_.scene.materials.data());
    }

    FilterGuide guide_of(const CellRow& row, int x, int y) const {
        for (const auto& samples : row.samples)
            if (const GBufferPixel& pixel = samples->at(x, y); pixel.reflects_alone)
                return {pixel.cache.gather.position, pixel.point->vertex.point.frame.n, pixel.cache.footprint,
                        material_of(*pixel.point)};
        return {};
    }

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    CachePlan plan_;
    ResidualFilm found_;
    std::uint32_t max_depth_;
    IncidentRadiance source_, map_source_;  // the truth, or what stands for it; what maps hold
    GatherEstimate monte_carlo_;
    BrightSplit split_;
    DirectionGrid grid_;
    QuadraturePoints points_;
    DimEnvironment environment_;

    PixelRect region_;  // that the pass computes
    std::vector<PixelSums> pixels_;
};

}  // namespace

std::unique_ptr<Integrator> make_block_cache(const RenderSettings& settings, const Transport& transport,
                                             const View& view, bool surface_layers) {
    return std::make_unique<BlockCache>(settings, cache_plan(settings), transport, view, surface_layers);
}

std::unique_ptr<Integrator> make_block_gather(const RenderSettings& settings, const Transport& transport,
                                              const View& view, bool surface_layers) {
    return std::make_unique<BlockCache>(settings, block_gather_plan(settings), transport, view,
                                        surface_layers);
}

}  // namespace relumine
