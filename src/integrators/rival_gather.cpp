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
#include "rivals/irradiance_cache.hpp"
#include "shading/reflectance.hpp"

namespace relumine {
namespace {

/// Light above so many times the environment's mean is sampled, not kept in records.
constexpr float bright_factor = 16;

/// Records of the first sample are placed with less error than they are used with, so that the pixels' other
/// samples find some, too [Krivanek09].
constexpr float first_share = 0.85f;

class RivalGather final : public Integrator {
  public:
    RivalGather(const RenderSettings& settings, const Transport& transport, const View& view,
                bool surface_layers)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          max_depth_(depth_limit(settings)),
          source_(incident_source(settings, transport)),
          split_(transport.scene, bright_factor, source_.field),
          lobes_(settings, source_, split_),
          irradiance_({settings.record_size, settings.accuracy}, source_, split_) {}

    [[nodiscard]] std::uint32_t longest_pass() const override { return 1; }

    [[nodiscard]] std::uint64_t known_bytes() const override {  // records are not: none is dropped
        return (sizeof(GBufferPixel) + sizeof(SitePoint))
               * static_cast<std::uint64_t>(view_.width) * static_cast<std::uint64_t>(view_.height);
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
        gbuffer_ = std::make_unique<GBuffer>(transport_, view_, frame, p.first_sample, max_depth_,
                                             surface_layers_, p.threads, p.rays);
        find_points(p.threads);
        SiteRun run{p.threads, p.stop, {}, {}};
        const auto point_at = [&](int x, int y) {
            const std::optional<SitePoint>& point = points_[number(x, y)];
            return point ? &*point : nullptr;
        };
        irradiance_.place(frame, point_at, p.first_sample == 0 ? first_share : 1, run);
        p.rays.add(run.rays);
        p.counts.add(run.counts);
    }

    void find_points(int threads) {
        points_.assign(number(0, view_.height), std::nullopt);
        parallel_for(threads, static_cast<std::size_t>(view_.height), [&](std::size_t row) {
            const int y = static_cast<int>(row);
            for (int x = 0; x < view_.width; ++x) {
                const GBufferPixel& pixel = gbuffer_->at(x, y);
                if (!pixel.point) continue;
                const Vertex& vertex = pixel.point->vertex;
                if (!is_black(split_lobes(vertex.bsdf, vertex.w_out).diffuse))
                    points_[number(x, y)] = site_point(pixel, x, y);
            }
        });
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

    SplitRadiance outgoing_radiance(const GBufferPixel& pixel, const std::optional<SitePoint>& site,
                                    std::vector<FoundSite>& found, CacheFigures& figures, Tile& tile) const {
        SplitRadiance sum{pixel.emission, {}, {}};
        if (!pixel.point) return sum;
        const ShadingPoint& x = *pixel.point;
        const LobeSplit split = split_lobes(x.vertex.bsdf, x.vertex.w_out);
        SplitRadiance reflected;
        if (site) {
            ++tile.cache.points;
            const auto e = irradiance_.at(*site, found, tile.rays, tile.cache);
            figures.records = static_cast<float>(found.size());
            reflected.direct = split.diffuse * inv_pi * e.direct;
            reflected.indirect = split.diffuse * inv_pi * e.indirect;
        } else {
            ++tile.cache.gathered;
        }
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

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    std::uint32_t max_depth_;
    IncidentRadiance source_;
    BrightSplit split_;
    LobeGather lobes_;
    IrradianceCache irradiance_;
    std::uint32_t placed_ = 0;                      // samples whose records are there
    std::unique_ptr<GBuffer> gbuffer_;              // of the pass
    std::vector<std::optional<SitePoint>> points_;  // of its pixels: where records are asked for
};

}  // namespace

std::unique_ptr<Integrator> make_irradiance_cache(const RenderSettings& settings, const Transport& transport,
                                                  const View& view, bool surface_layers) {
    return std::make_unique<RivalGather>(settings, transport, view, surface_layers);
}

}  // namespace relumine
