// SPDX-License-Identifier: Apache-2.0
// Cameras: the lens is sampled evenly and keeps in focus what it should; panoramas cover the sphere evenly.
#include "integrators/camera_rays.hpp"

#include <gtest/gtest.h>

#include "base/sample_stream.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr int draws = 200'000, side = 20;
constexpr double false_positive_rate = 1e-6;

/// χ² of points of a disk of radius 1 over cells of equal area.
template <typename F>
double disk_p(const F& point) {
    std::vector<double> observed(side * side), expected(side * side, double{draws} / (side * side));
    for (std::uint32_t i = 0; i < draws; ++i) {
        const Point2 p = point(SampleStream{5, i, 1, PointSet::independent}.next2(Dim::direction));
        const float r2 = sqr(p.x) + sqr(p.y), turn = std::atan2(p.y, p.x) / (2 * pi) + 0.5f;
        const int row = std::clamp(static_cast<int>(r2 * side), 0, side - 1);
        const int column = std::clamp(static_cast<int>(turn * side), 0, side - 1);
        ++observed[static_cast<std::size_t>(row * side + column)];
    }
    return testing::chi_square_p(observed, expected);
}

Camera with_lens() {
    Camera camera;
    camera.lens_radius = 0.2;
    camera.focus_distance = 3;
    return camera;
}

TEST(CameraRays, TheLensIsSampledEvenly) {
    const CameraRays rays(with_lens(), 40, 30);
    const auto p = [&](auto change) {
        return disk_p([&](Point2 u) {
            const Vec3 origin = rays.through({10, 20}, change(u)).origin;
            return Point2{origin.x / 0.2f, origin.y / 0.2f};
        });
    };
    EXPECT_GT(p([](Point2 u) { return u; }), false_positive_rate);
    EXPECT_LT(p([](Point2 u) { return Point2{0.99f * u.x, u.y}; }), false_positive_rate);
}

TEST(CameraRays, AllRaysOfAPixelMeetInTheFocalPlane) {
    const CameraRays rays(with_lens(), 40, 30);
    const auto in_focus = [&](Point2 pixel, Point2 lens) {
        const Ray ray = rays.through(pixel, lens);
        return ray.origin + ray.direction.v * ((-3 - ray.origin.z) / ray.direction.v.z);
    };
    for (std::uint32_t i = 0; i < 500; ++i) {
        const SampleStream stream{6, i, 1, PointSet::independent};
        const Point2 u = stream.next2(Dim::direction), pixel{40 * stream.next1(Dim::lobe), 11};
        const Vec3 a = in_focus(pixel, u), b = in_focus(pixel, {0.5f, 0.5f});
        ASSERT_LT(length(a - b), 1e-5f);
    }
}

/// Equal-area panoramas: directions of evenly spread pixels are even in solid angle.
TEST(CameraRays, EqualAreaPanoramasAreEven) {
    Camera camera;
    camera.panorama = Panorama::equal_area;
    const auto p = [&](Panorama panorama) {
        camera.panorama = panorama;
        const CameraRays rays(camera, 64, 64);
        return disk_p([&](Point2 u) {
            const Vec3 d = rays.through({64 * u.x, 64 * u.y}).direction.v;
            const float r = std::sqrt((1 - d.y) / 2), across = std::hypot(d.x, d.z);
            return Point2{r * d.x / across, r * d.z / across};
        });
    };
    EXPECT_GT(p(Panorama::equal_area), false_positive_rate);
    EXPECT_LT(p(Panorama::lat_long), false_positive_rate);  // crowds the poles
}

}  // namespace
}  // namespace relumine
