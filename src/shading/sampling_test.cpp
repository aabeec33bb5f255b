// SPDX-License-Identifier: Apache-2.0
// The maps that all samplers are made of follow their densities: χ², each with a mutant that is caught.
#include "shading/sampling.hpp"

#include <gtest/gtest.h>

#include <functional>

#include "base/sample_stream.hpp"
#include "shading/ggx.hpp"
#include "tests/statistics.hpp"

namespace relumine {
namespace {

constexpr int draws = 400'000, side = 24;  // cells along each side
constexpr double false_positive_rate = 1e-6;

/// Where a sample lands in a square whose density is known; outside of [0, 1]² it belongs to no cell.
using Map = std::function<Point2(Point2)>;
/// The probability of the square [0, x] × [0, y].
using Distribution = std::function<double(double x, double y)>;

double even(double x, double y) { return x * y; }

double p_value(const Map& map, const Distribution& distribution = even) {
    std::vector<double> observed(side * side + 1), expected(observed.size());
    for (std::uint32_t i = 0; i < draws; ++i) {
        const SampleStream stream{11, i, 1, PointSet::independent};
        const Point2 p = map(stream.next2(Dim::direction));
        const bool inside = p.x >= 0 && p.y >= 0 && p.x <= 1 && p.y <= 1;
        const int x = std::min(static_cast<int>(p.x * side), side - 1),
                  y = std::min(static_cast<int>(p.y * side), side - 1);
        ++observed[inside ? static_cast<std::size_t>(y * side + x) : side * side];
    }
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const auto f = [&](int i, int j) {
                return distribution(static_cast<double>(i) / side, static_cast<double>(j) / side);
            };
            expected[static_cast<std::size_t>(y * side + x)] =
                draws * (f(x + 1, y + 1) - f(x, y + 1) - f(x + 1, y) + f(x, y));
        }
    return testing::chi_square_p(observed, expected);
}

float turns(float y, float x) {
    const float angle = std::atan2(y, x) / (2 * pi);
    return angle < 0 ? angle + 1 : angle;
}

/// Uniform over the disk: r² and the angle are uniform.
Point2 disk_cell(Point2 d) { return {sqr(d.x) + sqr(d.y), turns(d.y, d.x)}; }

TEST(Sampling, ConcentricDiskIsUniform) {
    EXPECT_GT(p_value([](Point2 u) { return disk_cell(concentric_disk(u)); }), false_positive_rate);
    const Map polar = [](Point2 u) {  // crowds the middle
        return disk_cell({u.x * std::cos(2 * pi * u.y), u.x * std::sin(2 * pi * u.y)});
    };
    EXPECT_LT(p_value(polar), false_positive_rate);
}

TEST(Sampling, CosineHemisphereFollowsTheCosine) {  // sin² θ is uniform
    const auto cell = [](LocalDir w) { return Point2{1 - sqr(w.v.z), turns(w.v.y, w.v.x)}; };
    EXPECT_GT(p_value([&](Point2 u) { return cell(cosine_hemisphere(u)); }), false_positive_rate);
    const Map uniform = [&](Point2 u) {
        const float sine = std::sqrt(1 - sqr(u.x));
        return cell({{sine * std::cos(2 * pi * u.y), sine * std::sin(2 * pi * u.y), u.x}});
    };
    EXPECT_LT(p_value(uniform), false_positive_rate);
}

TEST(Sampling, TrianglesAreCoveredEvenly) {  // (1 − b₂)² and b₁ / (1 − b₂) are uniform
    const auto cell = [](Point2 b) { return Point2{sqr(1 - b.y), b.x / std::max(1 - b.y, 1e-12f)}; };
    EXPECT_GT(p_value([&](Point2 u) { return cell(uniform_triangle(u)); }), false_positive_rate);
    const Map folded_wrongly = [&](Point2 u) { return cell({u.x * (1 - u.y), u.y}); };
    EXPECT_LT(p_value(folded_wrongly), false_positive_rate);
}

TEST(Sampling, CapsAreUniformInSolidAngle) {
    for (const float lowest : {0.0f, 0.3f, 1.0f}) {
        const auto cell = [&](Vec3 w) { return Point2{(w.z + lowest) / (1 + lowest), turns(w.y, w.x)}; };
        EXPECT_GT(p_value([&](Point2 u) { return cell(sample_cap(lowest, u)); }), false_positive_rate)
            << lowest;
        EXPECT_LT(p_value([&](Point2 u) { return cell(sample_cap(0.97f * lowest + 0.02f, u)); }),
                  false_positive_rate)
            << lowest;
    }
}

/// Seen straight on, visible normals have the density D(m) cos θ: P(θ ≤ t) = tan² t / (α² + tan² t).
TEST(Sampling, VisibleNormalsFollowTheDistributionOfNormals) {
    for (const float alpha : {0.05f, 0.3f, 1.0f}) {
        const auto cell = [&](LocalDir m) {
            const float tan2 = (sqr(m.v.x) + sqr(m.v.y)) / sqr(m.v.z);
            return Point2{tan2 / (sqr(alpha) + tan2), turns(m.v.y, m.v.x)};
        };
        const LocalDir up{{0, 0, 1}};
        const auto drawn = [&](float a) {
            return p_value([&, a](Point2 u) {
                return cell(sample_visible_normal({a, Masking::correlated}, up, u));
            });
        };
        EXPECT_GT(drawn(alpha), false_positive_rate) << alpha;
        EXPECT_LT(drawn(1.03f * alpha), false_positive_rate) << alpha;
    }
}

}  // namespace
}  // namespace relumine
