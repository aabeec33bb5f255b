// SPDX-License-Identifier: Apache-2.0
// From pixels to rays.
#pragma once

#include "base/frame.hpp"
#include "scene/scene_data.hpp"
#include "trace/tracer.hpp"

namespace relumine {

/// A camera made ready for a picture of a given size: the vertical extent is kept, the aspect is the
/// picture's.
class CameraRays {
  public:
    CameraRays(const Camera& camera, int width, int height);

    /// The ray through a point of the picture in pixels, (0, 0) being the outer corner of the top left pixel;
    /// through the middle of the lens where there is one.
    [[nodiscard]] Ray through(Point2 pixel) const;
    /// The same through another point of the lens, uniform over it for `lens` uniform in [0, 1)².
    [[nodiscard]] Ray through(Point2 pixel, Point2 lens) const;
    [[nodiscard]] bool has_lens() const { return lens_radius_ > 0; }

  private:
    [[nodiscard]] Ray panoramic(Point2 pixel) const;

    bool orthographic_;
    Panorama panorama_;
    float width_, height_;
    float lens_radius_, focus_distance_;  // scene units
    Vec3 origin_, right_, up_, forward_;  // world; right and up span half the picture at unit distance
    Frame axes_;                          // unit: right, up, forward
};

}  // namespace relumine
