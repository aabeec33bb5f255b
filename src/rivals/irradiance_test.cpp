// SPDX-License-Identifier: Apache-2.0
// Irradiance and its gradients against polygons' closed form; wrong strata are caught.
#include "rivals/irradiance.hpp"

#include <gtest/gtest.h>

#include "base/hash.hpp"
#include "cache/test_stage.hpp"

namespace relumine {
namespace {

using testing::Quad;
using testing::Stage;

constexpr float sky = 0.5f;

/// A bright wall, a dark board before a part of the sky, and a lamp overhead: all above the horizon.
std::vector<Quad> walls() {
    return {{{1, -0.8f, 0.2f}, {0, 2, 0}, {0, 0, 1.5f}, Spectrum{3, 2, 1}},
            {{-0.9f, -0.2f, 0.4f}, {0.5f, 0.4f, 0}, {0, 0, 0.6f}, Spectrum{0}},
            {{-0.3f, -1.2f, 1.4f}, {0.8f, 0, 0}, {0, 0.6f, 0.1f}, Spectrum{2, 4, 6}}};
}

/// π times the form factor of a quad, by its edges [Lambert]; the quad must lie above the horizon.
double form(const Quad& q, Vec3 p, Vec3 n) {
    const std::array corners{q.corner, q.corner + q.a, q.corner + q.a + q.b, q.corner + q.b};
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec3 from = normalize(corners[i] - p), to = normalize(corners[(i + 1) % 4] - p);
        const Vec3 edge = cross(from, to);
        const double sine = length(edge), angle = std::atan2(sine, static_cast<double>(dot(from, to)));
        sum += 0.5 * angle * dot(n, edge) / sine;
    }
    return std::abs(sum);
}

/// Green irradiance.
double exact(Vec3 p, Vec3 n) {
    double e = static_cast<double>(pi) * sky;
    for (const Quad& q : walls()) e += (q.radiance.g - sky) * form(q, p, n);
    return e;
}

struct Derivatives {
    double value;
    Vec3 translation, rotation;
};

Derivatives exact_derivatives(Vec3 p, const Frame& frame) {
    constexpr float step = 1e-2f;
    Derivatives d{exact(p, frame.n), {}, {}};
    for (const Vec3 axis : {frame.s, frame.t}) {
        d.translation +=
            axis
            * static_cast<float>((exact(p + axis * step, frame.n) - exact(p - axis * step, frame.n))
                                 / (2 * step));
        const auto turned = [&](float angle) {
            return exact(p, frame.n * std::cos(angle) + cross(axis, frame.n) * std::sin(angle));
        };
        d.rotation += axis * static_cast<float>((turned(step) - turned(-step)) / (2 * step));
    }
    return d;
}

PolarHemisphere seen(const Stage& stage, Vec3 p, const Frame& frame, int rays, std::uint64_t key) {
    const FlushDenormals flush;
    const BrightSplit nothing_bright(stage.scene(), 1e6f);
    RayCounts counts;
    return trace_polar(stage.source(), nothing_bright, {p, frame, frame.n, 1e-5f, 0, 0, key},
                       polar_grid(Rings::cosine, rays), counts);
}

/// The mean over `records` hemispheres, whose strata `change` may spoil.
template <typename Change>
Derivatives estimated(const Stage& stage, Vec3 p, const Frame& frame, const Change& change) {
    constexpr std::uint64_t records = 8;
    Derivatives sum{0, {}, {}};
    for (std::uint64_t key = 0; key < records; ++key) {
        PolarHemisphere h = seen(stage, p, frame, 128, key);
        change(h);
        const SplitIrradiance e = irradiance_of(h, frame);
        sum.value += e.value().g / records;
        sum.translation += e.direct.translation.g / records;
        sum.rotation += e.direct.rotation.g / records;
    }
    return sum;
}

/// The largest error over a few places, of each derivative relative to its length there.
struct Deviation {
    double value = 0, translation = 0, rotation = 0;
};
template <typename Change>
Deviation deviation(const Change& change) {
    const Stage stage(walls(), Spectrum{sky});
    Deviation worst;
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{0.3f, 0.2f, 0}, Vec3{-0.2f, -0.5f, 0.05f}}) {
        const Frame frame = frame_around(normalize({0.02f * p.x, 0.01f, 1}));
        const Derivatives truth = exact_derivatives(p, frame), found = estimated(stage, p, frame, change);
        worst.value = std::max(worst.value, std::abs(found.value / truth.value - 1));
        const auto relative = [](Vec3 a, Vec3 b) { return static_cast<double>(length(a - b) / length(b)); };
        worst.translation = std::max(worst.translation, relative(found.translation, truth.translation));
        worst.rotation = std::max(worst.rotation, relative(found.rotation, truth.rotation));
    }
    return worst;
}

TEST(IrradianceGradient, IsThatOfTheClosedForm) {
    const Deviation d = deviation([](PolarHemisphere&) {});
    EXPECT_LT(d.value, 0.005);
    EXPECT_LT(d.translation, 0.05);
    EXPECT_LT(d.rotation, 0.02);
}

TEST(IrradianceGradient, WrongStrataAreCaught) {
    const auto mirrored = [](PolarHemisphere& h) {
        for (int ring = 0; ring < h.grid.rings; ++ring)
            std::reverse(&h.samples[h.grid.index(ring, 0)],
                         &h.samples[h.grid.index(ring, 0)] + h.grid.sectors);
    };
    EXPECT_GT(deviation(mirrored).translation, 0.05);
    const auto other_rings = [](PolarHemisphere& h) { h.grid.kind = Rings::even; };
    EXPECT_GT(deviation(other_rings).translation, 0.05);
    const auto farther = [](PolarHemisphere& h) {
        for (PolarSample& s : h.samples) s.distance *= 1.15f;
    };
    EXPECT_GT(deviation(farther).translation, 0.05);
}

TEST(IrradianceGradient, ExtrapolatesALittleWayAndTurn) {
    const Stage stage(walls(), Spectrum{sky});
    const Frame frame = frame_around({0, 0, 1});
    const SplitIrradiance e = irradiance_of(seen(stage, {}, frame, 128, 3), frame);
    const Vec3 offset{0.06f, -0.04f, 0}, normal = normalize({0.06f, 0.05f, 1});
    const double there = exact(offset, normal), here = exact({}, frame.n);
    const double found = extrapolated(e.direct, frame.n, offset, normal).g;
    EXPECT_GT(std::abs(there - here), 0.1);
    EXPECT_NEAR(found, there, 0.15 * std::abs(there - here));
}

TEST(Irradiance, OfAnEvenSkyIsExactAndDoesNotChange) {
    const Stage stage({}, Spectrum{2, 1, 0.5f});
    const Frame frame = frame_around(normalize({1, 2, 3}));
    const SplitIrradiance e = irradiance_of(seen(stage, {}, frame, 32, 1), frame);
    EXPECT_NEAR(e.value().r, 2 * pi, 1e-4f);
    EXPECT_NEAR(e.value().b, 0.5f * pi, 1e-4f);
    EXPECT_EQ(e.direct.translation.r, Vec3{});
    EXPECT_LT(length(e.direct.rotation.r), 1e-4f);
    EXPECT_EQ(change_length(e), infinity);
}

TEST(PolarGrid, StrataAreAsManyAsAskedForAndFillTheHemisphere) {
    for (const Rings kind : {Rings::cosine, Rings::even})
        for (const int rays : {16, 32, 64, 128}) {
            const PolarGrid grid = polar_grid(kind, rays);
            const auto wanted = static_cast<float>(rays * rays);
            EXPECT_NEAR(static_cast<float>(grid.size()), wanted, 0.02f * wanted);
            EXPECT_EQ(grid.cosine(0), 1);
            EXPECT_EQ(grid.cosine(static_cast<float>(grid.rings)), 0);
        }
}

}  // namespace
}  // namespace relumine
