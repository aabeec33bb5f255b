// SPDX-License-Identifier: Apache-2.0
// The Monte Carlo gather: prefix, direct light of lights without extent, gather rays.
#include "integrators/gather.hpp"

#include "integrators/gather_estimate.hpp"
#include "integrators/path_tracer.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

class Gather final : public Integrator {
  public:
    Gather(const RenderSettings& settings, const Transport& transport, const View& view, bool surface_layers)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          max_depth_(depth_limit(settings)),
          estimate_(settings, transport, view) {}

    void render(Tile& tile) const override {
        for_each_camera_packet(view_, transport_.tracer, tile, [&](const CameraPacket& samples) {
            for (const CameraSample& s : samples) {
                if (!tile.contains(s.x, s.y)) continue;
                const SplitRadiance radiance = outgoing_radiance(s, tile.rays);
                tile.add(s.x, s.y, s.stream.index, radiance,
                         surface_layers_ ? first_surface(transport_, s) : FirstSurface{});
            }
        });
    }

  private:
    SplitRadiance outgoing_radiance(const CameraSample& s, RayCounts& rays) const {
        SplitRadiance sum;
        const std::optional<ShadingPoint> x = follow_prefix(transport_, s, {max_depth_}, sum.emission, rays);
        if (!x) return sum;
        const SplitRadiance gathered = estimate_.reflected(*x, s.stream, rays);
        const Spectrum delta =
            delta_light(transport_, x->vertex, s.stream.bits(Dim::opacity, 2 * x->path.depth + 1), rays);
        sum.direct = x->path.throughput * (gathered.direct + delta);
        const Spectrum caustics = caustic_light(transport_, x->vertex, x->path.depth, max_depth_);
        sum.indirect = x->path.throughput * (gathered.indirect + caustics);
        return sum;
    }

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    std::uint32_t max_depth_;
    GatherEstimate estimate_;
};

}  // namespace

std::unique_ptr<Integrator> make_gather(const RenderSettings& settings, const Transport& transport,
                                        const View& view, bool surface_layers) {
    return std::make_unique<Gather>(settings, transport, view, surface_layers);
}

}  // namespace relumine
