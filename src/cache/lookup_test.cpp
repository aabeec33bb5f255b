// SPDX-License-Identifier: Apache-2.0
// Lookup against every record, ties, limits.
#include "cache/lookup.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/hash.hpp"

namespace relumine {
namespace {

/// Numbers in [0, 1), one after the other.
class Numbers {
  public:
    explicit Numbers(std::uint64_t seed) : seed_(seed) {}
    float next() { return unit_float(static_cast<std::uint32_t>(hash(seed_, count_++))); }
    Vec3 in_cube(float side) {
        const float x = next(), y = next(), z = next();
        return Vec3{x - 0.5f, y - 0.5f, z - 0.5f} * side;
    }
    Vec3 direction() {
        for (;;) {
            const Vec3 p = in_cube(2);
            if (const float l = length(p); l > 0.1f && l < 1) return p / l;
        }
    }

  private:
    std::uint64_t seed_, count_ = 0;
};

struct Place {
    Vec3 position, normal{0, 0, 1};
    float reach = 1;
    int x = 0, y = 0, pixel_reach = 1000;
};

CacheEntry entry_at(const Place& place) {
    CacheEntry entry;
    entry.record.position = place.position;
    entry.record.frame = frame_around(place.normal);
    entry.record.reach = place.reach;
    entry.x = place.x;
    entry.y = place.y;
    entry.pixel_reach = place.pixel_reach;
    return entry;
}

Query query_at(Vec3 position, Vec3 normal = {0, 0, 1}, int x = 0, int y = 0) {
    return {{position, frame_around(normal)}, x, y};
}

RadianceCache cache_of(const std::vector<Place>& places, std::uint32_t first_id = 0) {
    RadianceCache cache(first_id);
    for (const Place& place : places) cache.add(entry_at(place));
    return cache;
}

std::vector<FoundRecord> find(const RadianceCache& cache, const Query& query,
                              const ReuseLimits& limits = {}) {
    const std::array<const RadianceCache*, 1> caches{&cache};
    std::vector<FoundRecord> found{{nullptr, 99, 0}};  // what was there is forgotten
    find_records(caches, query, limits, found);
    return found;
}

std::vector<std::uint32_t> ids(const std::vector<FoundRecord>& found) {
    std::vector<std::uint32_t> out;
    for (const FoundRecord& record : found) out.push_back(record.id);
    return out;
}

/// Reaches over six orders of magnitude, normals within some 45°, pixels all over.
std::vector<Place> random_places(std::uint64_t seed, std::size_t count, float side) {
    Numbers random(seed);
    std::vector<Place> places(count);
    for (Place& place : places) {
        place.position = random.in_cube(side);
        place.normal = normalize(Vec3{0, 0, 1} + random.direction() * 0.5f);
        place.reach = side * std::pow(10.0f, -6 * random.next());
        place.x = static_cast<int>(100 * random.next());
        place.y = static_cast<int>(100 * random.next());
        place.pixel_reach = 1 << static_cast<int>(8 * random.next());
    }
    return places;
}

Query random_query(Numbers& random, const std::vector<Place>& places, float side) {
    // half of them anywhere, half near a record, where small reaches matter
    const auto near = static_cast<std::size_t>(random.next() * static_cast<float>(places.size()));
    const bool anywhere = random.next() < 0.5f;
    const Vec3 position =
        anywhere ? random.in_cube(side) : places[near].position + random.in_cube(2 * places[near].reach);
    return query_at(position, normalize(Vec3{0, 0, 1} + random.direction() * 0.3f),
                    static_cast<int>(100 * random.next()), static_cast<int>(100 * random.next()));
}

/// The definition: all records, sorted.
std::vector<std::uint32_t> brute_force(const std::vector<Place>& places, const Query& query,
                                       const ReuseLimits& limits) {
    std::vector<std::pair<float, std::uint32_t>> all;
    for (std::uint32_t id = 0; id < places.size(); ++id)
        if (const float bad = unsuitability(entry_at(places[id]), query, limits); bad < infinity)
            all.emplace_back(bad, id);
    std::sort(all.begin(), all.end());
    std::vector<std::uint32_t> out;
    for (const auto& [bad, id] : all)
        if (out.size() < static_cast<std::size_t>(limits.records_per_point)) out.push_back(id);
    return out;
}

TEST(Lookup, FindsWhatLookingAtEveryRecordFinds) {
    std::size_t found_at_all = 0;
    for (const float side : {1e-3f, 1.0f, 1e4f}) {
        const std::vector<Place> places = random_places(1, 1500, side);
        const RadianceCache cache = cache_of(places);
        ASSERT_EQ(cache.size(), places.size());
        Numbers random(2);
        for (int i = 0; i < 700; ++i) {
            const Query query = random_query(random, places, side);
            const ReuseLimits limits{0.8f + 0.19f * random.next(), 1 + static_cast<int>(16 * random.next())};
            const std::vector<std::uint32_t> expected = brute_force(places, query, limits);
            ASSERT_EQ(ids(find(cache, query, limits)), expected) << i;
            found_at_all += expected.size();
        }
    }
    EXPECT_GT(found_at_all, 2000u);  // there was something to find
}

TEST(Lookup, TwoCachesAreAsOne) {
    const std::vector<Place> places = random_places(3, 1000, 1);
    const RadianceCache kept = cache_of({places.begin(), places.begin() + 600});
    const RadianceCache added = cache_of({places.begin() + 600, places.end()}, 600);
    Numbers random(4);
    for (int i = 0; i < 300; ++i) {
        const Query query = random_query(random, places, 1);
        const ReuseLimits limits{0.8f, 5};
        std::vector<FoundRecord> found;
        for (const auto& caches : {std::array{&kept, &added}, std::array{&added, &kept}}) {
            find_records(caches, query, limits, found);
            ASSERT_EQ(ids(found), brute_force(places, query, limits)) << i;
        }
    }
}

TEST(Lookup, TheOrderOfAddingDoesNotShow) {
    const std::vector<Place> places = random_places(5, 800, 1);
    std::vector<Place> reversed(places.rbegin(), places.rend());
    const RadianceCache forwards = cache_of(places), backwards = cache_of(reversed);
    Numbers random(6);
    for (int i = 0; i < 300; ++i) {
        const Query query = random_query(random, places, 1);
        std::vector<std::uint32_t> there = ids(find(forwards, query)), back = ids(find(backwards, query));
        for (std::uint32_t& id : back) id = static_cast<std::uint32_t>(places.size()) - 1 - id;
        ASSERT_EQ(there, back) << i;
    }
}

TEST(Lookup, TiesGoToTheLowerId) {
    // The same distance by symmetry, in cells that the index keeps apart.
    const std::vector<Place> around{{{0.5f, 0, 0}},  {{-0.5f, 0, 0}}, {{0, 0.5f, 0}},
                                    {{0, -0.5f, 0}}, {{0, 0, -0.5f}}, {{0.5f, 0, 0}}};
    const RadianceCache cache = cache_of(around);
    const Query middle = query_at({0, 0, 0});
    EXPECT_EQ(ids(find(cache, middle, {0.9f, 4})), (std::vector<std::uint32_t>{0, 1, 2, 3}));
    EXPECT_EQ(ids(find(cache, middle, {0.9f, 16})), (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5}));
    const RadianceCache later = cache_of({{{0, 0.5f, 0}}}, 6);
    std::vector<FoundRecord> found;
    find_records(std::array{&later, &cache}, middle, {0.9f, 1}, found);
    EXPECT_EQ(ids(found), (std::vector<std::uint32_t>{0}));
}

TEST(Lookup, NearerAndBetterAlignedComesFirst) {
    const Vec3 tilted = normalize(Vec3{0.2f, 0, 1});
    const RadianceCache cache =
        cache_of({{{0.9f, 0, 0}}, {{0.1f, 0, 0}}, {{0.1f, 0, 0}, tilted}, {{0, 0, 0}}});
    const auto found = find(cache, query_at({0, 0, 0}), {0.9f, 4});
    EXPECT_EQ(ids(found), (std::vector<std::uint32_t>{3, 1, 2, 0}));
    EXPECT_EQ(found.front().unsuitability, 0);
    EXPECT_EQ(found.front().entry->record.position, (Vec3{0, 0, 0}));
}

TEST(Lookup, ReachIsALimitToTheEnd) {
    for (const float reach : {0.25f, 1.0f, 7.0f})  // 2 · 1 is a power of two: the sphere fills its cells
        for (const Vec3 p : {Vec3{0, 0, 0}, {1, 2, 3}, {-5, 0.5f, -0.25f}}) {
            const RadianceCache cache = cache_of({{p, {0, 0, 1}, reach}});
            for (const Vec3 axis : {Vec3{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}}) {
                EXPECT_EQ(find(cache, query_at(p + axis * reach)).size(), 1u) << reach;
                EXPECT_TRUE(find(cache, query_at(p + axis * (1.001f * reach))).empty()) << reach;
            }
        }
}

TEST(Lookup, PointsBehindARecordDoNotUseIt) {  // the floor beside a box does not see what the box's top sees
    const RadianceCache cache = cache_of({{{0, 0, 0}}});
    EXPECT_TRUE(find(cache, query_at({0.3f, 0, -0.3f})).empty());
    EXPECT_TRUE(find(cache, query_at({0, 0, -0.01f})).empty());
    EXPECT_EQ(find(cache, query_at({0.3f, 0, 0.3f})).size(), 1u);
    EXPECT_EQ(find(cache, query_at({0.3f, 0, -0.01f})).size(), 1u);  // no plane is that flat
}

TEST(Lookup, PixelsAreALimitToTheEnd) {
    Place place;
    place.x = 40;
    place.y = 50;
    place.pixel_reach = 8;
    const RadianceCache cache = cache_of({place});
    for (const auto& [x, y] : {std::pair{48, 50}, {32, 58}, {40, 42}, {48, 42}})
        EXPECT_EQ(find(cache, query_at({0, 0, 0}, {0, 0, 1}, x, y)).size(), 1u);
    for (const auto& [x, y] : {std::pair{49, 50}, {31, 50}, {40, 59}, {40, 41}})
        EXPECT_TRUE(find(cache, query_at({0, 0, 0}, {0, 0, 1}, x, y)).empty());
}

TEST(Lookup, NormalsAreALimit) {
    const RadianceCache cache = cache_of({{{0, 0, 0}}});
    const auto at_angle = [&](float cosine) {
        return find(cache, query_at({0, 0, 0}, {std::sqrt(1 - sqr(cosine)), 0, cosine}), {0.9f, 3}).size();
    };
    EXPECT_EQ(at_angle(0.91f), 1u);
    EXPECT_EQ(at_angle(0.89f), 0u);
    EXPECT_EQ(at_angle(-1), 0u);  // the wall's other side
}

TEST(Lookup, NoMoreRecordsThanWanted) {
    const RadianceCache cache = cache_of(std::vector<Place>(20));
    for (const int most : {1, 3, 16, 20, 50})
        EXPECT_EQ(find(cache, query_at({0, 0, 0}), {0.9f, most}).size(),
                  static_cast<std::size_t>(std::min(most, 20)));
}

TEST(Lookup, AnEmptyCacheHasNothing) {
    EXPECT_TRUE(find(RadianceCache{}, query_at({0, 0, 0})).empty());
    std::vector<FoundRecord> found{{nullptr, 0, 0}};
    find_records({}, query_at({0, 0, 0}), {}, found);
    EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace relumine
