// SPDX-License-Identifier: Apache-2.0
// Filling the G-buffer.
#include "integrators/gbuffer.hpp"

#include <mutex>

#include "base/executor.hpp"
#include "cache/receiver_bsdf.hpp"

namespace relumine {
namespace {

constexpr int block = 16;  // pixels along each side of a piece of work

CachePoint cache_point(const View& view, const CameraSample& s, const ShadingPoint& x) {
    const SurfacePoint& p = x.vertex.point;
    return {{p.position, frame_around(p.geometric_normal), p.offset, x.path.depth},
            s.x,
            s.y,
            pixel_footprint(view, s.x, s.y, x.distance),
            hash(s.stream.key, s.stream.index, 0x7265636f7264)};
}

GBufferPixel pixel_of(const Transport& t, const View& view, const CameraSample& s,
                      const PrefixSettings& prefix, bool surface_layers, RayCounts& rays) {
    GBufferPixel pixel;
    pixel.stream = s.stream;
    pixel.point = follow_prefix(t, s, prefix, pixel.emission, rays);
    if (surface_layers) pixel.surface = first_surface(t, s);
    if (!pixel.point) return pixel;
    pixel.reflects_alone = receiver_bsdf(pixel.point->vertex, pixel.point->vertex.point.frame).has_value();
    if (pixel.reflects_alone) pixel.cache = cache_point(view, s, *pixel.point);
    return pixel;
}

std::vector<PixelRect> blocks_of(const PixelRect& region) {
    std::vector<PixelRect> blocks;
    for (int y = region.y0 / block * block; y < region.y1; y += block)
        for (int x = region.x0 / block * block; x < region.x1; x += block)
            blocks.push_back({std::max(x, region.x0), std::max(y, region.y0), std::min(x + block, region.x1),
                              std::min(y + block, region.y1)});
    return blocks;
}

}  // namespace

float pixel_footprint(const View& view, int x, int y, float distance) {
    const auto through = [&](float column) {
        return view.camera.through({static_cast<float>(x) + column, static_cast<float>(y) + 0.5f});
    };
    const Ray here = through(0.5f), beside = through(1.5f);
    return length((beside.origin - here.origin) + (beside.direction.v - here.direction.v) * distance);
}

GBuffer::GBuffer(const Transport& t, const View& view, const PixelRect& region, std::uint32_t sample,
                 const PrefixSettings& prefix, bool surface_layers, int threads, RayCounts& rays)
    : region_(region),
      pixels_(static_cast<std::size_t>(region.width()) * static_cast<std::size_t>(region.height())) {
    const std::vector<PixelRect> blocks = blocks_of(region);
    std::mutex mutex;
    parallel_for(threads, blocks.size(), [&](std::size_t i) {
        Tile tile{blocks[i], sample, 1, {}, {}, {}, 0, {}};
        for_each_camera_packet(view, t.tracer, tile, [&](const CameraPacket& samples) {
            for (const CameraSample& s : samples)
                if (tile.contains(s.x, s.y))
                    pixels_[static_cast<std::size_t>(s.y - region_.y0)
                                * static_cast<std::size_t>(region_.width())
                            + static_cast<std::size_t>(s.x - region_.x0)] =
                        pixel_of(t, view, s, prefix, surface_layers, tile.rays);
        });
        const std::lock_guard lock(mutex);
        rays.add(tile.rays);
    });
}

}  // namespace relumine
