// SPDX-License-Identifier: Apache-2.0
// Radii that neighbours clamp, weights, and the grid against every site.
#include "rivals/sites.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr float accuracy = 0.25f;

float number(std::uint64_t i) { return unit_float(static_cast<std::uint32_t>(mix(i))); }

/// Sites in the unit cube with radii from 10^−`decades` to 1.
std::vector<Site> some_sites(std::size_t count, std::uint64_t seed, float decades = 2) {
    std::vector<Site> sites;
    for (std::uint64_t i = 0; i < count; ++i) {
        const auto n = [&](std::uint64_t k) { return number(hash(seed, 8 * i + k)); };
        const Vec3 normal = normalize(Vec3{n(3) - 0.5f, n(4) - 0.5f, 2});
        sites.push_back({{n(0), n(1), n(2)}, normal, std::pow(10.0f, -decades * n(6)), 0.005f});
    }
    return sites;
}

Sites added(const std::vector<Site>& all, std::size_t at_a_time) {
    Sites sites(accuracy);
    for (std::size_t i = 0; i < all.size(); i += at_a_time)
        sites.add({all.begin() + static_cast<std::ptrdiff_t>(i),
                   all.begin() + static_cast<std::ptrdiff_t>(std::min(all.size(), i + at_a_time))},
                  2);
    return sites;
}

/// The most that any radius exceeds a neighbour's and the way to it.
float worst_step(const Sites& sites) {
    float worst = 0;
    for (std::size_t i = 0; i < sites.size(); ++i)
        for (std::size_t j = 0; j < sites.size(); ++j)
            worst = std::max(
                worst, sites[i].radius - sites[j].radius - length(sites[i].position - sites[j].position));
    return worst;
}

TEST(Sites, NoRadiusExceedsANeighboursAndTheWayToIt) {
    const std::vector<Site> all = some_sites(300, 1);
    Sites unclamped(accuracy);
    float before = 0;
    for (const Site& a : all)
        for (const Site& b : all)
            before = std::max(before, a.radius - b.radius - length(a.position - b.position));
    EXPECT_GT(before, 0.5f);
    EXPECT_LE(worst_step(added(all, 300)), 1e-6f);
}

TEST(Sites, ClampingDoesNotDependOnTheOrderInWhichSitesCome) {
    const std::vector<Site> all = some_sites(200, 2);
    const Sites at_once = added(all, 200), one_by_one = added(all, 1);
    for (std::size_t i = 0; i < all.size(); ++i) EXPECT_EQ(at_once[i].radius, one_by_one[i].radius);
}

TEST(Sites, ClampingLeavesTheLeastRadius) {
    std::vector<Site> all{{{0, 0, 0}, {0, 0, 1}, 1, 0.5f}, {{0.1f, 0, 0}, {0, 0, 1}, 0.01f, 0.01f}};
    const Sites sites = added(all, 2);
    EXPECT_EQ(sites[0].radius, 0.5f);
    EXPECT_EQ(sites[1].radius, 0.01f);
}

TEST(Sites, FindsWhatLookingAtEverySiteFinds) {
    const Sites sites = added(some_sites(400, 3, 0.5f), 37);
    std::size_t in_all = 0;
    std::vector<FoundSite> found;
    for (std::uint64_t i = 0; i < 500; ++i) {
        const auto n = [&](std::uint64_t k) { return number(hash(77, 8 * i + k)); };
        const Vec3 p{n(0), n(1), n(2)}, normal = normalize(Vec3{n(3) - 0.5f, n(4) - 0.5f, 2});
        std::vector<std::uint32_t> expected, ids;
        for (std::uint32_t id = 0; id < sites.size(); ++id)
            if (use_error(sites[id], p, normal) < accuracy) expected.push_back(id);
        sites.find(p, normal, found);
        for (const FoundSite& f : found) {
            ids.push_back(f.id);
            EXPECT_GT(f.weight, 0);
        }
        std::ranges::sort(ids);
        EXPECT_EQ(ids, expected);
        EXPECT_EQ(sites.covers(p, normal, 1), !expected.empty());
        in_all += expected.size();
    }
    EXPECT_GT(in_all, 50u);
}

TEST(Sites, WeightsFadeToNothingWhereRecordsEnd) {
    EXPECT_EQ(use_weight(accuracy, accuracy), 0);
    EXPECT_LT(use_weight(0.99f * accuracy, accuracy), 0.05f);
    EXPECT_GT(use_weight(0.5f * accuracy, accuracy), 0.9f / accuracy);
    EXPECT_TRUE(std::isfinite(use_weight(0, accuracy)));
}

TEST(Sites, WhatLiesBehindARecordDoesNotUseIt) {
    const Site site{{0, 0, 0}, {0, 0, 1}, 1, 0};
    EXPECT_EQ(use_error(site, {0.05f, 0, -0.05f}, {0, 0, 1}), infinity);
    EXPECT_LT(use_error(site, {0.05f, 0, 0.05f}, {0, 0, 1}), accuracy);
    EXPECT_GT(use_error(site, {0, 0, 0}, {0, 0.6f, 0.8f}), accuracy);  // 37°
}

TEST(Sites, RadiiStayWithinBoundsOfPixels) {
    const float footprint = 0.01f;
    const SiteRadius usual = site_radius(0.3f, 0.5f, footprint, accuracy);
    EXPECT_EQ(usual.radius, 0.3f);
    EXPECT_EQ(usual.gradient_scale, 1);
    EXPECT_EQ(site_radius(0.5f, 0.3f, footprint, accuracy).radius, 0.3f);
    const SiteRadius corner = site_radius(0.01f, 1, footprint, accuracy);
    EXPECT_FLOAT_EQ(accuracy * corner.radius, least_reach * footprint);
    EXPECT_FLOAT_EQ(corner.gradient_scale, 0.01f / corner.radius);
    EXPECT_FLOAT_EQ(accuracy * site_radius(infinity, infinity, footprint, accuracy).radius,
                    most_reach * footprint);
}

}  // namespace
}  // namespace relumine
