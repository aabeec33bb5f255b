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
        for_each_camera_batch(view_, transport_.tracer, tile, [&](std::span<const CameraPacket> batch) {
            const std::size_t packets = batch.size();
            std::array<PathPacket, batch_packets> paths;
            std::array<StreamPacket, batch_packets> streams;
            for (std::size_t p = 0; p < packets; ++p)
                for (std::size_t i = 0; i < packet_size; ++i) {
                    paths[p][i] = batch[p][i].path;
                    streams[p][i] = batch[p][i].stream;
                }
            std::array<RadiancePacket, batch_packets> radiance;
            path_radiance(transport_, std::span(paths).first(packets), max_depth_,
                          std::span(streams).first(packets), std::span(radiance).first(packets), tile.rays);
            for (std::size_t p = 0; p < packets; ++p) add_samples(tile, batch[p], radiance[p]);
        });
    }

  private:
    void add_samples(Tile& tile, const CameraPacket& samples, const RadiancePacket& radiance) const {
        for (std::size_t i = 0; i < packet_size; ++i) {
            const CameraSample& s = samples[i];
            if (!tile.contains(s.x, s.y)) continue;
            tile.add(s.x, s.y, s.stream.index, radiance[i],
                     surface_layers_ ? first_surface(transport_, s) : FirstSurface{});
        }
    }

    const Transport& transport_;
    const View& view_;
    std::uint32_t max_depth_;
    bool surface_layers_;
};

}  // namespace

std::unique_ptr<Integrator> make_path_tracer(const RenderSettings& settings, const Transport& transport,
                                             const View& view, bool surface_layers) {
    return std::make_unique<PathTracer>(transport, view, depth_limit(settings), surface_layers);
}

std::uint32_t depth_limit(const RenderSettings& settings) {
    return settings.max_depth < 0 ? unlimited_depth : static_cast<std::uint32_t>(settings.max_depth);
}

}  // namespace relumine
