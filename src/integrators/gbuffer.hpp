// SPDX-License-Identifier: Apache-2.0
// All points that a picture's light is gathered at, before anything else is done with them [V, §3.1].
#pragma once

#include "cache/placement.hpp"
#include "integrators/shading_point.hpp"

namespace relumine {

/// What a camera sample has led to.
struct GBufferPixel {
    SampleStream stream;
    Spectrum emission;                  // of what was met on the way
    std::optional<ShadingPoint> point;  // where light is gathered; empty: there is no such place
    bool reflects_alone = false;        // the BSDF takes its light from the hemisphere above the point alone
    CachePoint cache;                   // only where `reflects_alone`
    FirstSurface surface;               // only if asked for
};

/// Metres that a pixel covers, across the view, at a distance along its ray.
[[nodiscard]] float pixel_footprint(const View& view, int x, int y, float distance);

/// One sample of each pixel of a region.
class GBuffer {
  public:
    /// Traces sample `sample` of the pixels of `region`, whole packets at a time.
    GBuffer(const Transport& t, const View& view, const PixelRect& region, std::uint32_t sample,
            const PrefixSettings& prefix, bool surface_layers, int threads, RayCounts& rays);

    [[nodiscard]] const PixelRect& region() const { return region_; }
    /// `x`, `y` in the region.
    [[nodiscard]] const GBufferPixel& at(int x, int y) const {
        return pixels_[static_cast<std::size_t>(y - region_.y0) * static_cast<std::size_t>(region_.width())
                       + static_cast<std::size_t>(x - region_.x0)];
    }

  private:
    PixelRect region_;
    std::vector<GBufferPixel> pixels_;  // row-major over region_
};

}  // namespace relumine
