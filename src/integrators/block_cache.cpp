// SPDX-License-Identifier: Apache-2.0
// The pipeline of `cache`, row of cells by row of cells: camera hits, records, maps, integrals, residual
// rays; then the filter over what the residual rays have found.
#include "integrators/block_cache.hpp"

#include <algorithm>
#include <mutex>

#include "base/executor.hpp"
#include "base/pixel_rect.hpp"
#include "integrators/cell_light.hpp"
#include "integrators/light_source.hpp"
#include "integrators/path_tracer.hpp"
#include "integrators/residual_film.hpp"
#include "radiance/caustic_map.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t samples_per_pass = 16;  // that share maps

/// Radiance over which light is bright, and below which relative errors do not matter, against the
/// environment's mean.
constexpr float bright_factor = 128, least_level = 0.05f;

/// Of a record, about.
constexpr std::uint64_t usual_record_bytes = 55'000;

/// Texels along each side of the world's square.
constexpr int grid_side = 64;

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
          monte_carlo_(monte_carlo_settings(settings), transport, view),
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
        return count(region()) * sizeof(PixelSums) + found_.bytes(region().width(), region().height())
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
        found_.begin(region_.width());
        const ResidualFilm::Adding how{plan_.exact, !split_.empty(), p.threads};
        constexpr int margin = CellRows::reach * cell_pixels;
        const MapSource maps{map_source_, split_, grid_, environment_};
        CellRows rows({transport_, view_, surface_layers_, max_depth_, maps}, plan_, region_);
        for (int y = region_.y0 - margin; y < region_.y1 + margin && !p.stop(); y += cell_pixels) {
            rows.take_in(y, p);
            if (!rows.ready()) continue;
            found_.take_in(std::min(rows.ready()->rect.y1, region_.y1) - region_.y0);
            light_row(rows, p);
            rows.release();
            found_.add_to(pixels_, how);
            if (p.progress) p.progress(static_cast<double>(y - cell_pixels - region_.y0) / region_.height());
        }
        // After a stop, too: what is lit may be all there is to show.
        found_.finish(pixels_, how);
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
            RayCounts rays;
            CacheCounts counts;
            WorkDone dropped;
            LitCell lit = light_cell(light_source(), here, cell, rows.maps_around(i), rays, counts);
            for (int y = cell.y0; y < cell.y1; ++y)
                for (int x = cell.x0; x < cell.x1; ++x) {
                    Tile sums = make_tile({x, y, x + 1, y + 1}, 0, 0);
                    sums.probe = p.probe;
                    finish_pixel(here, lit, sums, rays);
                    if (contains(view_.window, x, y)) dropped.add(sums.non_finite, sums.first_non_finite);
                }
            const std::lock_guard lock(mutex);
            p.rays.add(rays);
            p.counts.add(counts);
            p.dropped.add(dropped.non_finite, dropped.first_non_finite);
        });
    }

    [[nodiscard]] CellLightSource light_source() const {
        return {transport_,
                monte_carlo_,
                {source_, split_, environment_, plan_.rays},
                grid_,
                points_,
                plan_,
                found_.estimates_noise()};
    }

    /// `sums`: of the pixel, empty.
    void finish_pixel(const CellRow& row, LitCell& cell, Tile& sums, RayCounts& rays) {
        const int x = sums.rect.x0, y = sums.rect.y0;
        PixelResidual residual;
        DoubtSum doubt;
        for (const LitSample& sample : cell.at(x, y)) finish_sample(sample, sums, residual, doubt, rays);
        pixels_[index_of(x, y)] = sums.pixels[0];
        if (found_.estimates_noise())
            found_.put(x - region_.x0, y - region_.y0, residual, doubt.finish(), guide_of(row, x, y));
    }

    /// Adds a sample with all its light; what is to be filtered goes into `residual` instead.
    void finish_sample(const LitSample& sample, Tile& sums, PixelResidual& residual, DoubtSum& doubt,
                       RayCounts& rays) const {
        const GBufferPixel& pixel = *sample.pixel;
        SplitRadiance radiance{pixel.emission, {}, {}};
        Spectrum throughput;
        SampledRadiance found, lobes;
        if (pixel.point) {
            SplitRadiance reflected = sample.reflected;
            if (!pixel.reflects_alone) reflected = monte_carlo_.reflected(*pixel.point, pixel.stream, rays);
            reflected.direct += sample.delta;
            reflected.indirect +=
                caustic_light(transport_, pixel.point->vertex, pixel.point->path.depth, max_depth_);
            throughput = pixel.point->path.throughput;
            found = finite_or_nothing(sample.sampled, rays);
            if (sample.lobes) lobes = finite_or_nothing(*sample.lobes, rays);
            radiance.direct = throughput * reflected.direct;
            radiance.indirect = throughput * reflected.indirect;
        }
        if (found_.estimates_noise())
            doubt.add(found, lobes, throughput, radiance.total(), sample.albedo, sample.deviation);
        // What sharp lobes show is as fine as pixels, lamps in glossy ones too: no filter.
        add(lobes, throughput, radiance);
        radiance.direct += throughput * (found.residual.bright.mirrored + found.light.mirrored);
        if (plan_.filters) {
            residual.bright += throughput * (found.residual.bright.radiance + found.light.radiance);
            residual.direct += throughput * found.residual.dim.direct;
            residual.indirect += throughput * found.dim_indirect();
            residual.albedo += throughput * sample.albedo;
        } else {
            add(found, throughput, radiance);
        }
        CacheFigures figures;
        figures.records = sample.maps;
        sums.add(sums.rect.x0, sums.rect.y0, pixel.stream.index, radiance, pixel.surface, figures);
    }

    static void add(const SampledRadiance& found, Spectrum throughput, SplitRadiance& radiance) {
        radiance.direct +=
            throughput * (found.residual.dim.direct + found.residual.bright.radiance + found.light.radiance);
        radiance.indirect += throughput * found.dim_indirect();
    }

    /// What is not finite must not spread in the filter.
    static SampledRadiance finite_or_nothing(const SampledRadiance& found, RayCounts& rays) {
        const FoundResidual& r = found.residual;
        if (is_finite(r.dim.direct + found.dim_indirect() + r.bright.radiance + r.bright.mirrored
                      + found.light.radiance + found.light.mirrored))
            return found;
        ++rays.non_finite;
        return {};
    }

    [[nodiscard]] std::uint32_t material_of(const ShadingPoint& point) const {
        return static_cast<std::uint32_t>(point.vertex.point.material - transport_.scene.materials.data());
    }

    [[nodiscard]] static bool of_one_surface(const GBufferPixel& a, const GBufferPixel& b) {
        constexpr float least_cosine = 0.95f;
        return a.point->vertex.point.material == b.point->vertex.point.material
               && dot(a.point->vertex.point.frame.n, b.point->vertex.point.frame.n) > least_cosine;
    }

    /// Of the surface that most samples show: a pixel that has only its rim in one would be alone.
    FilterGuide guide_of(const CellRow& row, int x, int y) const {
        const GBufferPixel* shown = nullptr;
        std::size_t most = 0;
        for (const auto& samples : row.samples) {
            const GBufferPixel& pixel = samples->at(x, y);
            if (!pixel.reflects_alone || (shown && of_one_surface(*shown, pixel))) continue;
            const auto alike =
                static_cast<std::size_t>(std::ranges::count_if(row.samples, [&](const auto& s) {
                    return s->at(x, y).reflects_alone && of_one_surface(pixel, s->at(x, y));
                }));
            if (alike > most) shown = &pixel, most = alike;
        }
        if (!shown) return {};
        return {shown->cache.gather.position, shown->point->vertex.point.frame.n, shown->cache.footprint,
                material_of(*shown->point)};
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
