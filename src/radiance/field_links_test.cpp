// SPDX-License-Identifier: Apache-2.0
// Light over links: geometric series, and what packing costs.
#include "radiance/field_links.hpp"

#include <gtest/gtest.h>

#include <array>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr int rays = 128;

/// Two elements that see nothing but each other, of this albedo.
FieldLinks facing(Spectrum albedo, std::uint8_t lobes = 0) {
    FieldLinks links;
    for (ElementId e = 0; e < 2; ++e) {
        for (std::uint16_t r = 0; r < rays; ++r) links.links.push_back(make_link(1 - e, r, r, albedo, lobes));
        links.end_element();
    }
    return links;
}

TEST(FieldLinks, ReflectionsAddUpToTheGeometricSeries) {  // E = 1 / (1 − ρ), within 0.1 %
    for (const float albedo : {0.3f, 0.6f, 0.9f}) {
        const FieldLinks links = facing(Spectrum{albedo});
        const std::vector<Spectrum> light(2, Spectrum{1});
        std::vector<Spectrum> irradiance;
        iterate(links, {light, {}}, 1.0f / rays, 0xffffffffu, 1, irradiance);
        for (const Spectrum& e : irradiance) EXPECT_NEAR(e.g * (1 - albedo), 1, 1e-3f) << albedo;
    }
}

/// Light that is reflected hundreds of times is not followed so often: a chain of elements, each of which
/// sees the next ones, lit at one end. Jacobi iterations to the same sum take 400.
TEST(FieldLinks, ManyReflectionsAreFoundAtOnce) {
    constexpr ElementId count = 60;
    FieldLinks links;
    for (ElementId e = 0; e < count; ++e) {
        for (std::uint16_t r = 0; r < rays; ++r) {
            const ElementId to = r % 2 == 0 ? std::min(e + 1, count - 1) : std::max(e, 1u) - 1;
            links.links.push_back(make_link(to, r, r, {0.98f, 0.9f, 0.5f}, 0));
        }
        links.end_element();
    }
    std::vector<Spectrum> light(count), irradiance, reflected(count);
    light[0] = Spectrum{1};
    const Reflections done = iterate(links, {light, {}}, 1.0f / rays, 0xffffffffu, 1, irradiance);
    EXPECT_LT(done.computed(), 100u);
    for (ElementId e = 0; e < count; ++e)
        for (const Link& l : links.of(e)) reflected[e] += l.value() * irradiance[l.to] * (1.0f / rays);
    double off = 0, all = 0;
    for (ElementId e = 0; e < count; ++e) {
        off += luminance(light[e] + reflected[e] - irradiance[e]);
        all += luminance(irradiance[e]);
        EXPECT_GE(irradiance[e].b, 0);
    }
    EXPECT_NEAR(off / all, 0, 1e-5);  // of one reflection; some fifty times that of all
}

TEST(FieldLinks, AFewReflectionsAreItsPartialSum) {
    const FieldLinks links = facing(Spectrum{0.5f});
    const std::vector<Spectrum> light{Spectrum{1}, Spectrum{0}};
    std::vector<Spectrum> irradiance;
    EXPECT_EQ(iterate(links, {light, {}}, 1.0f / rays, 0, 1, irradiance).computed(), 0u);
    EXPECT_EQ(irradiance[1], Spectrum{0});
    EXPECT_EQ(iterate(links, {light, {}}, 1.0f / rays, 2, 1, irradiance).computed(), 2u);
    EXPECT_NEAR(irradiance[0].g, 1.25f, 1e-3f);
    EXPECT_NEAR(irradiance[1].g, 0.5f, 1e-3f);
}

/// Each way takes two lobes: three reflections. Light that a lobe has reflected comes after one.
TEST(FieldLinks, LobesTakeReflectionsOfALimitedNumber) {
    const FieldLinks links = facing(Spectrum{0.5f}, 2);
    const ElementLight light{{Spectrum{1}, Spectrum{0}}, {Spectrum{0}, Spectrum{0.25f}}};
    const auto after = [&](std::uint32_t bounces) {
        std::vector<Spectrum> irradiance;
        const Reflections done = iterate(links, light, 1.0f / rays, bounces, 1, irradiance);
        return std::array{irradiance[0].g, irradiance[1].g, done.share_without(1)};
    };
    const auto expect = [&](std::uint32_t bounces, float first, float second, float share) {
        const auto [a, b, without_one] = after(bounces);
        EXPECT_NEAR(a, first, 1e-3f) << bounces;
        EXPECT_NEAR(b, second, 1e-3f) << bounces;
        EXPECT_NEAR(without_one, share, 1e-3f) << bounces;
    };
    expect(0, 1, 0, 0);
    expect(1, 1, 0.25f, 0.8f);
    expect(2, 1, 0.25f, 1);
    expect(3, 1, 0.75f, 1.25f / 1.75f);
    expect(4, 1.125f, 0.75f, 1.75f / 1.875f);
    expect(0xffffffffu, 1.5f, 1, 1);
}

TEST(FieldLinks, ThreadsDoNotMatter) {
    const FieldLinks links = facing({0.9f, 0.5f, 0.1f});
    const std::vector<Spectrum> light{Spectrum{1}, Spectrum{3}};
    std::vector<Spectrum> one, seven;
    iterate(links, {light, {}}, 1.0f / rays, 50, 1, one);
    iterate(links, {light, {}}, 1.0f / rays, 50, 7, seven);
    EXPECT_EQ(one, seven);
}

TEST(FieldLinks, RoundingIsFairOnAverage) {
    for (const float value : {0.1234f, 0.77777f, 5.4321f}) {
        double sum = 0;
        constexpr int count = 20'000;
        for (int i = 0; i < count; ++i)
            sum += double{make_link(static_cast<ElementId>(i), 3, 5, Spectrum{value}, 0).value().r};
        EXPECT_NEAR(sum / count, value, 3e-5);
    }
}

TEST(FieldLinks, DirectionsSurvivePacking) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const auto number = [&](std::uint64_t what) {
            return unit_float(static_cast<std::uint32_t>(hash(i, what)));
        };
        const Vec3 w = normalize({2 * number(1) - 1, 2 * number(2) - 1, 0.5f + number(3)});
        EXPECT_GT(dot(unpack_direction(pack_direction({w})).v, w), 0.9998f);
    }
}

}  // namespace
}  // namespace relumine
