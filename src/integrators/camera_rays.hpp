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

    /// The ray through a point of the picture in pixels, (0, 0) being the outer corner of the top left pixel.
    [[nodiscard]] Ray through(Point2 pixel) const;

  private:
    bool orthographic_;
    float width_, height_;
    Vec3 origin_, right_, up_, forward_;  // world; right and up span half the picture at unit distance
};

}  // namespace relumine
