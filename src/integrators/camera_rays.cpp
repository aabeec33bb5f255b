// SPDX-License-Identifier: Apache-2.0
// From pixels to rays.
#include "integrators/camera_rays.hpp"

namespace relumine {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : orthographic_(camera.orthographic),
      width_(static_cast<float>(width)),
      height_(static_cast<float>(height)) {
    const Transform& m = camera.world_from_camera;
    // The matrix may carry a scale, as a whole scene's does when it is resized: it moves the camera but bends
    // no ray.
    const float half_height =
        static_cast<float>(orthographic_ ? 0.5 * camera.vertical_extent * length(m.vector({0, 1, 0}))
                                         : std::tan(0.5 * camera.vertical_extent));
    origin_ = m.point({});
    right_ = normalize(m.vector({1, 0, 0})) * (half_height * width_ / height_);
    up_ = normalize(m.vector({0, 1, 0})) * half_height;
    forward_ = normalize(m.vector({0, 0, -1}));
}

Ray CameraRays::through(Point2 pixel) const {
    const float x = 2 * pixel.x / width_ - 1, y = 1 - 2 * pixel.y / height_;
    const Vec3 on_picture = right_ * x + up_ * y;
    if (orthographic_) return {origin_ + on_picture, {forward_}};
    return {origin_, {normalize(forward_ + on_picture)}};
}

}  // namespace relumine
