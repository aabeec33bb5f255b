// SPDX-License-Identifier: Apache-2.0
// Camera samples: which rays a picture asks for and what they hit first.
#pragma once

#include <functional>

#include "base/sample_stream.hpp"
#include "base/tile.hpp"
#include "integrators/camera_rays.hpp"
#include "integrators/pixel_filter.hpp"
#include "radiance/path.hpp"

namespace relumine {

/// What turns pixels into camera samples.
struct View {
    CameraRays camera;
    PixelFilter filter;
    PointSet point_set = PointSet::sobol;
    std::uint64_t seed = 0;
    std::uint32_t samples_per_pixel = 1;
    int width = 0, height = 0;  // of the full frame, pixels
    PixelRect window;           // the part of it that is wanted
};

/// A camera ray and what it hit, as the beginning of a path.
struct CameraSample {
    int x = 0, y = 0;  // full frame
    SampleStream stream;
    PathState path;
};

using CameraPacket = std::array<CameraSample, packet_size>;

/// Calls `use` for every packet of samples that has a pixel in the tile: 4 × 4 pixels at multiples of 4 of
/// the full frame. A packet is always whole, so that a crop sees the same bits as the full picture, and may
/// hold pixels that the tile does not contain.
void for_each_camera_packet(const View& view, const Tracer& tracer, Tile& tile,
                            const std::function<void(const CameraPacket&)>& use);

/// The same in batches of packets: successive samples of the same pixels.
void for_each_camera_batch(const View& view, const Tracer& tracer, Tile& tile,
                           const std::function<void(std::span<const CameraPacket>)>& use);

/// What the layers about surfaces show of a camera sample.
[[nodiscard]] FirstSurface first_surface(const Transport& t, const CameraSample& sample);

}  // namespace relumine
