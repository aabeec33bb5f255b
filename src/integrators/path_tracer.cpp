// SPDX-License-Identifier: Apache-2.0
// The path tracer.
#include "integrators/path_tracer.hpp"

namespace relumine {
namespace {

class PathTracer final : public Integrator {
  public:
    PathTracer(const Transport& transport, const View& view, std::uint32_t max_depth, bool surface_layers)
        : transport_(transport), view_(view), max_depth_(max_depth), surface_layers_(surface_layers) {}

    void render(Tile& tile) const override {
        for_each_camera_sample(view_, transport_.tracer, tile, [&](const CameraSample& s) {
            const SplitRadiance radiance = path_radiance(transport_, s.path, max_depth_, s.stream, tile.rays);
            tile.add(s.x, s.y, s.stream.index, radiance, surface_layers_ ? first_surface(transport_, s) : FirstSurface{});
        });
    }

  private:
    const Transport& transport_;
    const View& view_;
    std::uint32_t max_depth_;
    bool surface_layers_;
};

}  // namespace

std::unique_ptr<Integrator> make_path_tracer(const RenderSettings& settings, const Transport& transport, const View& view,
                                             bool surface_layers) {
    return std::make_unique<PathTracer>(transport, view, depth_limit(settings), surface_layers);
}

std::uint32_t depth_limit(const RenderSettings& settings) {
    return settings.max_depth < 0 ? unlimited_depth : static_cast<std::uint32_t>(settings.max_depth);
}

}  // namespace relumine
