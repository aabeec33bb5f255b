// SPDX-License-Identifier: Apache-2.0
// The paper's pipeline: G-buffer, placement, then pixel by pixel lookup, reprojection, gaps, shading.
#include "integrators/cached_gather.hpp"

#include "base/pixel_rect.hpp"
#include "cache/gap_fill.hpp"
#include "integrators/gather_estimate.hpp"
#include "integrators/gbuffer.hpp"
#include "integrators/light_source.hpp"
#include "integrators/path_tracer.hpp"
#include "integrators/product_rays.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

/// Pixels along each side of the tiles that keep caches of their own, in scope `tile`.
constexpr int cache_tile_side = 64;

/// Tiles of scope `tile` may be worked on at a time, each with its share of the memory. A number of threads
/// would show in the picture.
constexpr std::uint64_t tiles_at_a_time = 16;

/// The records of a tile.
struct OwnCache {
    RadianceCache records;
    std::uint64_t room = no_limit;  // bytes for more

    void add(CacheEntry&& entry) {
        const std::uint64_t bytes = entry.record.bytes();
        if (bytes > room) return;
        if (room != no_limit) room -= bytes;
        records.add(std::move(entry));
    }
};

/// What a thread needs at hand for a point; too large to make anew each time.
struct Workspace {
    std::vector<FoundRecord> found;
    Reprojection incident;
    std::vector<GapRay> gap_rays;
    BsdfTable bsdf;
    std::vector<float> products;
    ProductDistribution distribution;
};

class CachedGather final : public Integrator {
  public:
    CachedGather(const RenderSettings& settings, const Transport& transport, const View& view,
                 bool surface_layers, bool product_rays)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          max_depth_(depth_limit(settings)),
          source_(incident_source(settings, transport)),
          monte_carlo_(settings, transport, view),
          settings_(cache_settings(settings)),
          per_tile_(settings.cache_scope == "tile") {
        if (product_rays)
            rays_ = split_rays(static_cast<std::uint32_t>(settings.gather_rays), settings.bsdf_share);
    }

    [[nodiscard]] int tile_side() const override {
        return per_tile_ ? cache_tile_side : Integrator::tile_side();
    }
    [[nodiscard]] std::uint32_t longest_pass() const override { return 1; }

    [[nodiscard]] std::uint64_t known_bytes() const override {  // records are not
        const PixelRect points = placement_region(view_, 0);
        return per_tile_ ? 0
                         : sizeof(GBufferPixel) * static_cast<std::uint64_t>(points.width())
                               * static_cast<std::uint64_t>(points.height());
    }

    void keep_within(std::uint64_t bytes) override { room_ = per_tile_ ? bytes / tiles_at_a_time : bytes; }

    /// The records of sample 0.
    void recover(Preparation& p) override {
        p.first_sample = 0;
        prepare(p);
    }

    void prepare(Preparation& p) override {
        if (per_tile_) return;
        gbuffer_ = std::make_unique<GBuffer>(transport_, view_, placement_region(view_, p.first_sample),
                                             p.first_sample, PrefixSettings{max_depth_}, surface_layers_,
                                             p.threads, p.rays);
        passing_ = RadianceCache(static_cast<std::uint32_t>(kept_.size()));
        const bool first = p.first_sample == 0;
        PlacementRun run{p.threads, p.stop, {}, {}, first ? room_ : room_for_passing_};
        const auto point_at = [&](int x, int y) {
            const GBufferPixel& pixel = gbuffer_->at(x, y);
            return pixel.reflects_alone ? &pixel.cache : nullptr;
        };
        const RadianceCache none;
        place_records(source_, gbuffer_->region(), point_at, settings_, first ? none : kept_,
                      first ? kept_ : passing_, run);
        if (first) room_for_passing_ = run.room;
        p.rays.add(run.rays);
        p.counts.add(run.counts);
    }

    void render(Tile& tile) const override {
        Workspace workspace;
        if (per_tile_) {
            render_with_own_cache(tile, workspace);
            return;
        }
        for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
            for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
                const GBufferPixel& pixel = gbuffer_->at(x, y);
                CacheFigures figures;
                const SplitRadiance radiance = outgoing_radiance(pixel, nullptr, workspace, figures, tile);
                tile.add(x, y, pixel.stream.index, radiance, pixel.surface, figures);
            }
    }

  private:
    /// The paper's thread-local cache: the tile's pixels in turn, each finding the records of those before
    /// it. The tile is done whole even where a crop shows a part of it alone.
    void render_with_own_cache(Tile& tile, Workspace& workspace) const {
        const int x0 = tile.rect.x0 / cache_tile_side * cache_tile_side,
                  y0 = tile.rect.y0 / cache_tile_side * cache_tile_side;
        const PixelRect whole = intersection({x0, y0, x0 + cache_tile_side, y0 + cache_tile_side},
                                             {0, 0, view_.width, view_.height});
        for (std::uint32_t sample = tile.first_sample; sample < tile.first_sample + tile.sample_count;
             ++sample) {
            const GBuffer points(transport_, view_, whole, sample, {max_depth_}, surface_layers_, 1,
                                 tile.rays);
            OwnCache own{RadianceCache{}, room_};
            for (int y = whole.y0; y < whole.y1; ++y)
                for (int x = whole.x0; x < whole.x1; ++x) {
                    const GBufferPixel& pixel = points.at(x, y);
                    CacheFigures figures;
                    const SplitRadiance radiance = outgoing_radiance(pixel, &own, workspace, figures, tile);
                    if (tile.contains(x, y)) tile.add(x, y, sample, radiance, pixel.surface, figures);
                }
        }
    }

    /// `own`: the cache that the point may add to, or null.
    SplitRadiance outgoing_radiance(const GBufferPixel& pixel, OwnCache* own, Workspace& w,
                                    CacheFigures& figures, Tile& tile) const {
        SplitRadiance sum{pixel.emission, {}, {}};
        if (!pixel.point) return sum;
        const ShadingPoint& x = *pixel.point;
        const SplitRadiance gathered =
            pixel.reflects_alone ? cached_radiance(pixel, own, w, figures, tile) : monte_carlo(pixel, tile);
        const Spectrum delta = delta_light(transport_, x.vertex,
                                           pixel.stream.bits(Dim::opacity, 2 * x.path.depth + 1), tile.rays);
        sum.direct = x.path.throughput * (gathered.direct + delta);
        const Spectrum caustics = caustic_light(transport_, x.vertex, x.path.depth, max_depth_);
        sum.indirect = x.path.throughput * (gathered.indirect + caustics);
        return sum;
    }

    SplitRadiance monte_carlo(const GBufferPixel& pixel, Tile& tile) const {
        ++tile.cache.gathered;
        return monte_carlo_.reflected(*pixel.point, pixel.stream, tile.rays);
    }

    /// Outgoing radiance from records: lookup, reprojection, gaps, shading [V, §3.3].
    SplitRadiance cached_radiance(const GBufferPixel& pixel, OwnCache* own, Workspace& w,
                                  CacheFigures& figures, Tile& tile) const {
        ++tile.cache.points;
        const Receiver receiver = reproject_to(pixel, own, w, tile);
        figures = {static_cast<float>(w.incident.records), static_cast<float>(w.incident.gaps()) / mask_bits,
                   static_cast<float>(w.incident.layers),
                   static_cast<float>(w.incident.unknown.count()) / mask_bits};
        GatherPoint point = pixel.cache.gather;
        point.frame = receiver.frame;
        {
            const StepTimer timer(tile.cache, CacheStep::gaps);
            fill_gaps(source_, point, settings_.gap_cell, gap_key(pixel.cache), w.incident, w.gap_rays,
                      tile.rays);
        }
        const ReflectedRadiance biased = shade_square(pixel, receiver, w, tile);
        if (rays_.product + rays_.bsdf == 0) return {{}, biased.direct, biased.total - biased.direct};
        const StepTimer timer(tile.cache, CacheStep::product);
        if (rays_.product > 0) w.distribution.build(w.products);
        return importance_sampled(source_, *pixel.point, pixel.stream, receiver.frame, w.distribution, rays_,
                                  tile.rays);
    }

    /// Fills w.incident from the records that suit; makes one of its own where there is none and the point
    /// may.
    Receiver reproject_to(const GBufferPixel& pixel, OwnCache* own, Workspace& w, Tile& tile) const {
        const CachePoint& point = pixel.cache;
        Receiver receiver{point.gather.position, point.gather.frame};
        {
            const StepTimer timer(tile.cache, CacheStep::lookup);
            const Query query{receiver, point.x, point.y};
            const std::array<const RadianceCache*, 2> shared{&kept_, &passing_};
            const RadianceCache* const tile_cache = own ? &own->records : nullptr;
            find_records(own ? std::span(&tile_cache, 1) : std::span<const RadianceCache* const>(shared),
                         query, settings_.reuse, w.found);
        }
        float gaps = 1;
        if (!w.found.empty()) {
            receiver.frame = receiver_frame(w.found.front().entry->record.frame, receiver.frame.n);
            gaps = cover(w.found, receiver, settings_, source_.reflects(), w.incident, tile.cache);
        }
        if (!w.found.empty() && (!own || gaps <= settings_.most_gaps)) return receiver;
        CacheEntry entry = make_entry(source_, point, cache_tile_side, settings_, tile.rays, tile.cache);
        receiver.frame = entry.record.frame;
        const FoundRecord itself{&entry, 0, 0};
        cover({&itself, 1}, receiver, settings_, source_.reflects(), w.incident, tile.cache);
        if (own) own->add(std::move(entry));
        return receiver;
    }

    ReflectedRadiance shade_square(const GBufferPixel& pixel, const Receiver& receiver, Workspace& w,
                                   Tile& tile) const {
        const StepTimer timer(tile.cache, CacheStep::shade);
        if (rays_.product > 0) w.products.resize(cell_count);
        return shade(w.incident, *receiver_bsdf(pixel.point->vertex, receiver.frame), w.bsdf, w.products);
    }

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    std::uint32_t max_depth_;
    IncidentRadiance source_;
    GatherEstimate monte_carlo_;
    CacheSettings settings_;
    bool per_tile_;
    RayShares rays_;                    // `reproject-mc` alone
    std::unique_ptr<GBuffer> gbuffer_;  // of the pass, scope `image` alone
    RadianceCache kept_, passing_;      // records of sample 0, and of the pass
    std::uint64_t room_ = no_limit;     // bytes for the records of sample 0, or of each tile
    std::uint64_t room_for_passing_ = no_limit;
};

}  // namespace

CacheSettings cache_settings(const RenderSettings& s) {
    CacheSettings c;
    c.record = {s.record_size, s.record_layers};
    c.reuse.records_per_point = s.records_per_point;
    c.spacing = s.record_spacing;
    c.gap_cell = s.gap_cell;
    return c;
}

PixelRect placement_region(const View& view, std::uint32_t first_sample) {
    // Records of sample 0 serve all samples; later samples add what they lack and drop it again, so that a
    // crop's border stays bounded: once for the records of sample 0, once for those that depend on them.
    const int border = first_sample == 0 ? 2 * placement_halo : placement_halo;
    return intersection(grown(view.window, border), {0, 0, view.width, view.height});
}

std::unique_ptr<Integrator> make_reproject(const RenderSettings& settings, const Transport& transport,
                                           const View& view, bool surface_layers) {
    return std::make_unique<CachedGather>(settings, transport, view, surface_layers, false);
}

std::unique_ptr<Integrator> make_reproject_mc(const RenderSettings& settings, const Transport& transport,
                                              const View& view, bool surface_layers) {
    return std::make_unique<CachedGather>(settings, transport, view, surface_layers, true);
}

}  // namespace relumine
