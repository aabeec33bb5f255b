// SPDX-License-Identifier: Apache-2.0
// What holds for all masks, records and receivers: RapidCheck draws random ones.
#include <gtest/gtest.h>

#include <bitset>

#include "base/rgbe.hpp"
#include "cache/gap_fill.hpp"
#include "cache/mask.hpp"
#include "cache/test_stage.hpp"
#include "tests/properties.hpp"

namespace relumine {
namespace {

using testing::holds;
using testing::Quad;
using testing::Stage;
using testing::unit_number;
using testing::within;

using Bits = std::bitset<mask_bits>;

/// Edges of the mask and of its words more often than others.
std::uint8_t random_edge() {
    return static_cast<std::uint8_t>(
        *rc::gen::element(0, 1, 63, 64, 65, 127, 128, *rc::gen::inRange(0, mask_side + 1)));
}
BitRect random_rect() { return {random_edge(), random_edge(), random_edge(), random_edge()}; }

std::size_t at(int x, int y) { return static_cast<std::size_t>(y * mask_side + x); }

/// `last`: the greatest bit that a rectangle of the definition reaches; less for the mutant.
void fill(Bits& bits, const BitRect& rect, int last = mask_side) {
    for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < std::min<int>(rect.x1, last); ++x) bits.set(at(x, y));
}

bool same(const Mask& mask, const Bits& bits) {
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x)
            if (mask.test(x, y) != bits.test(at(x, y))) return false;
    return mask.count() == static_cast<int>(bits.count());
}

TEST(CacheProperties, MasksAreSetsOfBits) {
    const auto sets = [](int last) {
        return holds("fill, and, or, not, count", [=] {
            Mask a, b;
            Bits bits_a, bits_b;
            for (int i = *rc::gen::inRange(0, 6); i > 0; --i) {
                const BitRect rect = random_rect(), other = random_rect();
                a.fill(rect);
                fill(bits_a, rect, last);
                b.fill(other);
                fill(bits_b, other, last);
            }
            RC_ASSERT(same(a, bits_a));
            RC_ASSERT(same(a & b, bits_a & bits_b));
            RC_ASSERT(same(a | ~b, bits_a | ~bits_b));
        });
    };
    EXPECT_TRUE(sets(mask_side));
    EXPECT_FALSE(sets(mask_side - 1));  // the mutant must be caught
}

TEST(CacheProperties, RowsGiveTheirBits) {
    EXPECT_TRUE(holds("bits(x, length)", [] {
        MaskRow row{*rc::gen::arbitrary<std::uint64_t>(), *rc::gen::arbitrary<std::uint64_t>()};
        const int x = *rc::gen::inRange(0, mask_side), length = *rc::gen::inRange(0, 33);
        const std::uint32_t bits = row.bits(x, length);
        for (int i = 0; i < 32; ++i)
            RC_ASSERT(((bits >> i & 1) != 0) == (i < length && x + i < mask_side && row.test(x + i)));
    }));
}

Spectrum random_radiance() { return {4 * unit_number(), unit_number(), 0.1f + unit_number()}; }

/// A few emissive quads at any distance, some through the horizon, some edge on.
Stage random_stage() {
    std::vector<Quad> quads;
    for (int i = *rc::gen::inRange(0, 4); i > 0; --i) {
        const float size = std::exp(within(-2, 2));
        const auto vector = [&] {
            return Vec3{within(-size, size), within(-size, size), within(-size, size)};
        };
        quads.push_back({vector() + Vec3{0, size, 0}, vector(), vector(), random_radiance()});
    }
    return {quads, unit_number() < 0.5f ? Spectrum{0} : random_radiance()};
}

Vec3 random_normal() { return normalize({within(-0.5f, 0.5f), 1, within(-0.5f, 0.5f)}); }

bool within_set(const Mask& part, const Mask& whole) { return (part & ~whole) == Mask{}; }

/// Invariants of what reprojection leaves behind.
void check(const Reprojection& seen) {
    RC_ASSERT((seen.covered & seen.unknown) == Mask{});
    RC_ASSERT(within_set(seen.lit, seen.covered));
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x) {
            if (!seen.lit.test(x, y)) continue;
            const Spectrum radiance = unpack_rgbe(seen.radiance[at(x, y)]);
            RC_ASSERT(is_finite(radiance));
            RC_ASSERT(std::min({radiance.r, radiance.g, radiance.b}) >= 0);
            RC_ASSERT(max_component(radiance) < 4.1f);  // no brighter than anything that there is
        }
}

TEST(CacheProperties, ReprojectionNeverContradictsItself) {
    EXPECT_TRUE(holds("masks and radiance after one and two records", [] {
        const Stage stage = random_stage();
        const int n = *rc::gen::element(16, 32);
        const auto position = [] {
            return Vec3{within(-0.3f, 0.3f), within(-0.05f, 0.05f), within(-0.3f, 0.3f)};
        };
        const Record record = stage.record(position(), random_normal(), n),
                     second = stage.record(position(), random_normal(), n);
        const Receiver receiver{position(), receiver_frame(record.frame, random_normal())};
        Reprojection seen;
        seen.clear(!record.direct.empty());
        reproject(record, receiver, seen);
        check(seen);
        const Mask before = seen.covered;
        reproject(second, receiver, seen);
        check(seen);
        RC_ASSERT(within_set(before, seen.covered));
    }));
}

TEST(CacheProperties, ARecordReproducesItselfWhereItWasMade) {
    const auto reproduces = [](float shift) {
        return holds("reprojection to the record's own place", [=] {
            const Stage stage = random_stage();
            const Record record = stage.record({0, within(0, 1e-3f), 0}, random_normal(), 32);
            Reprojection seen;
            seen.clear(!record.direct.empty());
            reproject(record, {record.position + record.frame.s * shift, record.frame}, seen);
            RC_ASSERT(seen.gaps() == 0);
            RC_ASSERT(seen.unknown.count() == 0);
            seen.blacken();
            for (int y = 0; y < mask_side; ++y)
                for (int x = 0; x < mask_side; ++x)
                    RC_ASSERT(seen.radiance[at(x, y)]
                              == record.radiance[static_cast<std::size_t>(y / 4 * 32 + x / 4)]);
        });
    };
    EXPECT_TRUE(reproduces(0));
    EXPECT_FALSE(reproduces(0.05f));  // the mutant must be caught
}

}  // namespace
}  // namespace relumine
