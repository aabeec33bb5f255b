// SPDX-License-Identifier: Apache-2.0
// From pixels to rays.
#include "integrators/camera_rays.hpp"

#include "base/equal_area.hpp"
#include "shading/sampling.hpp"

namespace relumine {

CameraRays::CameraRays(const Camera& camera, int width, int height)
    : orthographic_(camera.orthographic),
      panorama_(camera.panorama),
      width_(static_cast<float>(width)),
      height_(static_cast<float>(height)) {
    const Transform& m = camera.world_from_camera;
    // The matrix may carry a scale, as a whole scene's does when it is resized: it moves the camera but bends
    // no ray.
    const float half_height =
        static_cast<float>(orthographic_ ? 0.5 * camera.vertical_extent * length(m.vector({0, 1, 0}))
                                         : std::tan(0.5 * camera.vertical_extent));
    origin_ = m.point({});
    axes_ = {normalize(m.vector({1, 0, 0})), normalize(m.vector({0, 1, 0})), normalize(m.vector({0, 0, -1}))};
    right_ = axes_.s * (half_height * width_ / height_);
    up_ = axes_.t * half_height;
    forward_ = axes_.n;
    if (camera.stretch != 1) right_ = right_ * static_cast<float>(camera.stretch);
    if (camera.shift_x != 0 || camera.shift_y != 0) {
        const Vec3 shift = axes_.s * (half_height * static_cast<float>(camera.shift_x))
                           + axes_.t * (half_height * static_cast<float>(camera.shift_y));
        (orthographic_ ? origin_ : forward_) += shift;
    }
    const float scale = length(m.vector({0, 0, -1}));
    lens_radius_ = panorama_ == Panorama::none ? static_cast<float>(camera.lens_radius) * scale : 0.0f;
    focus_distance_ = static_cast<float>(camera.focus_distance) * scale;
}

Ray CameraRays::panoramic(Point2 pixel) const {
    const float u = pixel.x / width_, v = pixel.y / height_;
    if (panorama_ == Panorama::lat_long) {
        const float theta = pi * v, phi = 2 * pi * u;
        const Vec3 d{std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi)};
        return {origin_, {normalize(axes_.s * d.x + axes_.t * d.y + axes_.n * d.z)}};
    }
    const std::array<double, 3> d =
        equal_area_direction(std::clamp(double{u}, 0.0, 1.0), std::clamp(double{v}, 0.0, 1.0));
    const auto f = [&](std::size_t i) { return static_cast<float>(d[i]); };
    return {origin_, {normalize(axes_.s * f(0) + axes_.t * f(2) + axes_.n * f(1))}};
}

Ray CameraRays::through(Point2 pixel) const {
    if (panorama_ != Panorama::none) return panoramic(pixel);
    const float x = 2 * pixel.x / width_ - 1, y = 1 - 2 * pixel.y / height_;
    const Vec3 on_picture = right_ * x + up_ * y;
    if (orthographic_) return {origin_ + on_picture, {forward_}};
    return {origin_, {normalize(forward_ + on_picture)}};
}

Ray CameraRays::through(Point2 pixel, Point2 lens) const {
    const Ray middle = through(pixel);
    if (!has_lens()) return middle;
    const Vec3 in_focus =
        middle.origin + middle.direction.v * (focus_distance_ / dot(middle.direction.v, axes_.n));
    const Point2 disk = concentric_disk(lens);
    const Vec3 origin = middle.origin + (axes_.s * disk.x + axes_.t * disk.y) * lens_radius_;
    return {origin, {normalize(in_focus - origin)}};
}

}  // namespace relumine
