// SPDX-License-Identifier: Apache-2.0
// Camera samples in packets.
#include "integrators/view.hpp"

#include "base/sample_packet_kernel.hpp"
#include "shading/material.hpp"

namespace relumine {
namespace {

constexpr int block = 4;  // pixels along each side; block² = packet_size

CameraPacket trace_block(const View& view, const Tracer& tracer, int x0, int y0, std::uint32_t sample) {
    CameraPacket samples;
    StreamPacket streams;
    for (int lane = 0; lane < block * block; ++lane) {
        const auto i = static_cast<std::size_t>(lane);
        samples[i].x = x0 + lane % block;
        samples[i].y = y0 + lane / block;
        streams[i] = samples[i].stream = pixel_stream(view.seed, samples[i].x, samples[i].y, sample,
                                                      view.samples_per_pixel, view.point_set);
    }
    SamplePacket::Lanes<float> x, y, lens_x{}, lens_y{};
    SamplePacket::Lanes<std::uint32_t> opacity{};
    const SamplePacket numbers(streams);
    numbers.next2(Dim::pixel, 0, x, y);
    if (view.camera.has_lens()) numbers.next2(Dim::lens, 0, lens_x, lens_y);
    if (tracer.asks_for_opacity()) numbers.bits(Dim::opacity, 0, opacity);
    std::array<Ray, packet_size> rays;
    std::array<Hit, packet_size> hits;
    for (std::size_t i = 0; i < packet_size; ++i) {
        const Point2 in_pixel = view.filter.position({x[i], y[i]});
        rays[i] = view.camera.through(
            {static_cast<float>(samples[i].x) + in_pixel.x, static_cast<float>(samples[i].y) + in_pixel.y},
            {lens_x[i], lens_y[i]});
        rays[i].opacity_seed = opacity[i];
        samples[i].path.ray = rays[i];
    }
    tracer.closest_hits(rays, hits, Coherence::coherent);
    for (std::size_t i = 0; i < packet_size; ++i) {
        samples[i].path.hit = hits[i];
        if (tracer.has_coloured_panes()) samples[i].path.throughput = tracer.tint(rays[i], hits[i].t);
    }
    return samples;
}

}  // namespace

void for_each_camera_batch(const View& view, const Tracer& tracer, Tile& tile,
                           const std::function<void(std::span<const CameraPacket>)>& use) {
    const PixelRect& r = tile.rect;
    std::vector<CameraPacket> batch;
    for (int y0 = r.y0 / block * block; y0 < r.y1; y0 += block)
        for (int x0 = r.x0 / block * block; x0 < r.x1; x0 += block)
            for (std::uint32_t s = 0; s < tile.sample_count; ++s) {
                tile.rays.add(RayPurpose::camera, packet_size);
                batch.push_back(trace_block(view, tracer, x0, y0, tile.first_sample + s));
                if (batch.size() < batch_packets && s + 1 < tile.sample_count) continue;
                use(batch);
                batch.clear();
            }
}

void for_each_camera_packet(const View& view, const Tracer& tracer, Tile& tile,
                            const std::function<void(const CameraPacket&)>& use) {
    for_each_camera_batch(view, tracer, tile, [&](std::span<const CameraPacket> batch) {
        for (const CameraPacket& packet : batch) use(packet);
    });
}

FirstSurface first_surface(const Transport& t, const CameraSample& sample) {
    if (!sample.path.hit) return {};
    PathState path = sample.path;
    const Vertex vertex = make_vertex(t, path, sample.stream);
    const auto material = static_cast<float>(vertex.point.material - t.scene.materials.data() + 1);
    return {albedo(vertex.bsdf), vertex.point.frame.n, vertex.point.position, path.hit.t, material};
}

}  // namespace relumine
