// SPDX-License-Identifier: Apache-2.0
// The rivals' pipeline: placement over the whole frame, then pixel by pixel records, lobes and bright light.
#include "integrators/rival_gather.hpp"

#include "base/executor.hpp"
#include "integrators/gbuffer.hpp"
#include "integrators/light_source.hpp"
#include "integrators/lobe_gather.hpp"
#include "integrators/path_tracer.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/direct_light.hpp"
#include "rivals/harmonic_cache.hpp"
#include "rivals/irradiance_cache.hpp"
#include "shading/reflectance.hpp"

namespace relumine {
namespace {

/// Light above so many times the environment's mean is sampled, not kept in records.
constexpr float bright_factor = 16;

/// Records of the first sample are placed with less error than they are used with, so that the pixels' other
/// samples find some, too [Krivanek09].
constexpr float first_share = 0.85f;

/// What records hold of the light that a point reflects.
enum class Kept : std::uint8_t { nothing, irradiance, radiance };

struct CachedPoint {
    Kept kept = Kept::nothing;
    SitePoint site{};
};

class RivalGather final : public Integrator {
  public:
    RivalGather(const RenderSettings& settings, const Transport& transport, const View& view,
                bool surface_layers, bool keeps_radiance)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          max_depth_(depth_limit(settings)),
          source_(incident_source(settings, transport)),
          split_(transport.scene, bright_factor, source_.field),
          lobes_(settings, source_, split_),
          irradiance_({settings.record_size, settings.accuracy}, source_, split_) {
        if (keeps_radiance)
            radiance_.emplace(RivalSettings{settings.record_size, settings.accuracy}, settings.harmonics,
                              transport.masking, source_, split_);
    }

    [[nodiscard]] std::uint32_t longest_pass() const override { return 1; }

    [[nodiscard]] std::uint64_t known_bytes() const override {  // records are not: none is dropped
        return (sizeof(GBufferPixel) + sizeof(CachedPoint)) * static_cast<std::uint64_t>(view_.width)
               * static_cast<std::uint64_t>(view_.height);
    }

    /// Records of all samples are kept, so those before this pass are placed first where that is still to do:
    /// a render that goes on, or one sample once more.
    void prepare(Preparation& p) override {
        for (; placed_ < p.first_sample; ++placed_) {
            Preparation before = p;
            before.first_sample = placed_;
            before.rays = {};
            place(before);
        }
        place(p);
        placed_ = p.first_sample + 1;
    }

    void render(Tile& tile) const override {
        std::vector<FoundSite> found;
        for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
            for (int x = tile.rect.x0; x < tile.rect.x1; ++x) {
                const GBufferPixel& pixel = gbuffer_->at(x, y);
                CacheFigures figures;
                const SplitRadiance radiance =
                    outgoing_radiance(pixel, points_[number(x, y)], found, figures, tile);
                tile.add(x, y, pixel.stream.index, radiance, pixel.surface, figures);
            }
    }

  private:
    [[nodiscard]] std::size_t number(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(view_.width)
               + static_cast<std::size_t>(x);
    }

    /// Over the whole frame even where a crop shows a part of it alone: how far records depend on each other
    /// is not bounded in pixels.
    void place(Preparation& p) {
        const PixelRect frame{0, 0, view_.width, view_.height};
        gbuffer_ = std::make_unique<GBuffer>(transport_, view_, frame, p.first_sample,
                                             PrefixSettings{max_depth_}, surface_layers_, p.threads, p.rays);
        find_points(p.threads);
        SiteRun run{p.threads, p.stop, {}, {}};
        const auto point_at = [&](Kept kept) {
            return [&, kept](int x, int y) {
                const CachedPoint& point = points_[number(x, y)];
                return point.kept == kept ? &point.site : nullptr;
            };
        };
        const float share = p.first_sample == 0 ? first_share : 1;
        irradiance_.place(frame, point_at(Kept::irradiance), share, run);
        if (radiance_) radiance_->place(frame, point_at(Kept::radiance), share, run);
        p.rays.add(run.rays);
        p.counts.add(run.counts);
    }

    void find_points(int threads) {
        points_.assign(number(0, view_.height), {});
        parallel_for(threads, static_cast<std::size_t>(view_.height), [&](std::size_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < view_.width; ++x) {
                const GBufferPixel& pixel = gbuffer_->at(x, y);
                if (!pixel.point) continue;
                const Kept kept = kept_of(pixel.point->vertex);
                if (kept != Kept::nothing) points_[number(x, y)] = {kept, site_point(pixel, x, y)};
            }
        });
    }

    [[nodiscard]] Kept kept_of(const Vertex& vertex) const {
        if (radiance_ && radiance_->holds(vertex.bsdf)) return Kept::radiance;
        return is_black(split_lobes(vertex.bsdf, vertex.w_out).diffuse) ? Kept::nothing : Kept::irradiance;
    }

    [[nodiscard]] SitePoint site_point(const GBufferPixel& pixel, int x, int y) const {
        const SurfacePoint& p = pixel.point->vertex.point;
        return {p.position,
                p.frame,
                p.geometric_normal,
                p.offset,
                pixel.point->path.depth,
                pixel_footprint(view_, x, y, pixel.point->distance),
                hash(pixel.stream.key, pixel.stream.index, 0x72656365697074)};
    }

    SplitRadiance outgoing_radiance(const GBufferPixel& pixel, const CachedPoint& point,
                                    std::vector<FoundSite>& found, CacheFigures& figures, Tile& tile) const {
        SplitRadiance sum{pixel.emission, {}, {}};
        if (!pixel.point) return sum;
        const ShadingPoint& x = *pixel.point;
        LobeSplit split = split_lobes(x.vertex.bsdf, x.vertex.w_out);
        SplitRadiance reflected;
        if (point.kept == Kept::nothing) {
            ++tile.cache.gathered;
        } else {
            ++tile.cache.points;
            reflected = kept_light(x.vertex, point, split, found, tile);
            figures.records = static_cast<float>(found.size());
        }
        if (point.kept == Kept::radiance) split.lobes.reset();  // records hold them as well
        if (split.lobes) {
            const SplitRadiance glossy = lobes_.gathered(x, *split.lobes, pixel.stream, tile.rays);
            reflected.direct += glossy.direct;
            reflected.indirect += glossy.indirect;
        }
        reflected.direct += lobes_.bright(x, split.lobes ? &*split.lobes : nullptr, pixel.stream, tile.rays);
        reflected.direct += delta_light(transport_, x.vertex,
                                        pixel.stream.bits(Dim::opacity, 2 * x.path.depth + 1), tile.rays);
        reflected.indirect += caustic_light(transport_, x.vertex, x.path.depth, max_depth_);
        sum.direct = x.path.throughput * reflected.direct;
        sum.indirect = x.path.throughput * reflected.indirect;
        return sum;
    }

    SplitRadiance kept_light(const Vertex& vertex, const CachedPoint& point, const LobeSplit& split,
                             std::vector<FoundSite>& found, Tile& tile) const {
        if (point.kept == Kept::radiance) {
            const ReflectedLight light =
                radiance_->reflected(point.site, split.diffuse, *radiance_->holds(vertex.bsdf), vertex.w_out,
                                     found, tile.rays, tile.cache);
            return {{}, light.direct, light.indirect};
        }
        const PointIrradiance e = irradiance_.at(point.site, found, tile.rays, tile.cache);
        const Spectrum share = split.diffuse * inv_pi;
        return {{}, share * e.direct, share * e.indirect};
    }

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    std::uint32_t max_depth_;
    IncidentRadiance source_;
    BrightSplit split_;
    LobeGather lobes_;
    IrradianceCache irradiance_;
    std::uint32_t placed_ = 0;               // samples whose records are there
    std::unique_ptr<GBuffer> gbuffer_;       // of the pass
    std::optional<HarmonicCache> radiance_;  // `radiance-cache` alone
    std::vector<CachedPoint> points_;        // of its pixels
};

}  // namespace

std::unique_ptr<Integrator> make_irradiance_cache(const RenderSettings& settings, const Transport& transport,
                                                  const View& view, bool surface_layers) {
    return std::make_unique<RivalGather>(settings, transport, view, surface_layers, false);
}

std::unique_ptr<Integrator> make_radiance_cache(const RenderSettings& settings, const Transport& transport,
                                                const View& view, bool surface_layers) {
    return std::make_unique<RivalGather>(settings, transport, view, surface_layers, true);
}

}  // namespace relumine
