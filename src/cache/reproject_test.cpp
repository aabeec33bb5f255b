// SPDX-License-Identifier: Apache-2.0
// Properties of reprojection and gap filling [V, §3.3].
#include "cache/reproject.hpp"

#include <gtest/gtest.h>

#include "base/rgbe.hpp"
#include "cache/gap_fill.hpp"
#include "cache/hemisphere_map.hpp"
#include "cache/shade.hpp"
#include "cache/test_stage.hpp"

namespace relumine {
namespace {

using testing::Quad;
using testing::Stage;

const Spectrum red{1, 0, 0}, green{0, 1, 0}, blue{0, 0, 0.5f};
const Vec3 up{0, 1, 0};

Stage bar_and_wall() {
    return Stage(
        {{{-20, -20, -4}, {40, 0, 0}, {0, 60, 0}, green}, {{-0.5f, 0.4f, -1}, {1, 0, 0}, {0, 0.3f, 0}, red}},
        blue);
}

Reprojection reprojected(const Record& record, const Receiver& receiver) {
    Reprojection out;
    out.clear(!record.direct.empty());
    reproject(record, receiver, out);
    return out;
}

Receiver receiver_at(const Record& record, Vec3 position, Vec3 normal) {
    return {position, receiver_frame(record.frame, normalize(normal))};
}

class RecordSize : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Reproject, RecordSize, ::testing::Values(16, 32, 64, 128));

/// Snapping: a bit belongs to the rectangle that its centre is in, and texels' borders fall between centres,
/// half a bit from either. The corners' rounding errors (half floats: 1/40 bit) are far from that.
TEST_P(RecordSize, IdenticalPointReproducesTheTexture) {
    const int n = GetParam();
    const Record record = bar_and_wall().record({0.1f, 0, 0.2f}, normalize({0.1f, 1, 0.3f}), n);
    const Reprojection seen = reprojected(record, {record.position, record.frame});
    EXPECT_EQ(seen.gaps(), 0);
    EXPECT_EQ(seen.unknown.count(), 0);
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x)
            ASSERT_EQ(seen.radiance[static_cast<std::size_t>(y * mask_side + x)],
                      record.radiance[static_cast<std::size_t>(y * n / mask_side * n + x * n / mask_side)])
                << x << " " << y;
}

TEST(Reproject, LightFromInfinityStaysWhereItIsInTheWorld) {
    const Record record = Stage({}, blue).record({}, up);
    const Reprojection moved = reprojected(record, receiver_at(record, {7, 0, 3}, up));
    EXPECT_EQ(moved.gaps(), 0);
    const Reprojection tilted = reprojected(record, receiver_at(record, {7, 0, 3}, {0.1f, 1, 0}));
    EXPECT_EQ(tilted.unknown.count(), 0);
    EXPECT_GT(tilted.gaps(), mask_bits / 200);  // the sliver that was below the horizon
    EXPECT_LT(tilted.gaps(), mask_bits / 15);
}

/// What the receiver's own ray through the middle of a bit meets.
Spectrum truth(const Stage& stage, const Receiver& receiver, int x, int y) {
    const FlushDenormals flush;
    const Point2 center{(static_cast<float>(x) + 0.5f) / mask_side,
                        (static_cast<float>(y) + 0.5f) / mask_side};
    std::array<Ray, packet_size> rays;
    for (Ray& ray : rays) ray.t_max = -1;
    rays[0] = {receiver.position, receiver.frame.to_world(square_to_hemisphere(center)), infinity, 0};
    std::array<Hit, packet_size> hits;
    stage.source().transport.tracer.closest_hits(rays, hits, Coherence::incoherent);
    RayCounts counts;
    return incident_radiance(stage.source(), rays, hits, 1, {}, counts)[0].direct;
}

/// Bits where `seen` shows `shown` although the bar is there, and all neighbours of the bit are the bar's
/// too.
int shown_through_the_bar(const Stage& stage, const Receiver& receiver, const Reprojection& seen,
                          Spectrum shown) {
    int wrong = 0;
    constexpr int margin = 3;
    for (int y = margin; y < mask_side - margin; ++y)
        for (int x = margin; x < mask_side - margin; ++x) {
            if (unpack_rgbe(seen.radiance[static_cast<std::size_t>(y * mask_side + x)]) != shown) continue;
            bool inside = true;
            for (const auto& [dx, dy] : {std::pair{-margin, -margin},
                                         {margin, -margin},
                                         {-margin, margin},
                                         {margin, margin},
                                         {0, 0}})
                inside = inside && truth(stage, receiver, x + dx, y + dy) == red;
            wrong += inside;
        }
    return wrong;
}

TEST(Reproject, TheWallNeverShowsThroughTheBar) {
    const Stage stage = bar_and_wall();
    const Record left = stage.record({-0.25f, 0, 0}, up), right = stage.record({0.25f, 0, 0.1f}, up);
    for (const Vec3 at : {Vec3{0, 0, 0}, {-0.1f, 0, 0.05f}, {0.1f, 0, -0.2f}, {0.25f, 0, 0.1f}}) {
        const Receiver receiver = receiver_at(left, at, {0.02f, 1, 0.01f});
        Reprojection seen = reprojected(left, receiver);
        EXPECT_EQ(shown_through_the_bar(stage, receiver, seen, green), 0);
        reproject(right, receiver, seen);
        EXPECT_EQ(shown_through_the_bar(stage, receiver, seen, green), 0);
        EXPECT_EQ(shown_through_the_bar(stage, receiver, seen, blue), 0);
    }
    Reprojection all_wall;  // the check can fail
    all_wall.clear(false);
    std::ranges::fill(all_wall.radiance, pack_rgbe(green));
    EXPECT_GT(shown_through_the_bar(stage, receiver_at(left, {}, up), all_wall, green), 100);
}

TEST(Reproject, FartherLayersDoNotFillTheUnknown) {
    const Record record = bar_and_wall().record({}, up);
    const Reprojection seen = reprojected(record, receiver_at(record, {0.25f, 0, 0}, up));
    EXPECT_GT(seen.unknown.count(), 50);
    EXPECT_EQ((seen.unknown & seen.covered).count(), 0);
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x)
            ASSERT_TRUE(seen.covered.test(x, y)
                        || seen.radiance[static_cast<std::size_t>(y * mask_side + x)] == 0);
}

TEST(Reproject, ASecondRecordFillsWhatTheFirstLeftUnknown) {
    const Stage stage = bar_and_wall();
    const Record first = stage.record({}, up), second = stage.record({0.3f, 0, 0}, up);
    Reprojection seen = reprojected(first, receiver_at(first, {0.25f, 0, 0}, up));
    const Mask covered = seen.covered;
    const int gaps = seen.gaps();
    reproject(second, receiver_at(first, {0.25f, 0, 0}, up), seen);
    EXPECT_EQ((covered & ~seen.covered).count(), 0);  // nothing is taken back
    EXPECT_LT(seen.gaps(), gaps / 2);
    EXPECT_EQ(seen.records, 2);
}

TEST(GapFill, RaysStandForEveryOpenBitOnceAndGoThroughOneOfThem) {
    const Record record = bar_and_wall().record({}, up);
    const Reprojection seen = reprojected(record, receiver_at(record, {0.3f, 0, 0.1f}, {0.1f, 1, 0}));
    for (const int k : {1, 2, 4, 8}) {
        std::vector<GapRay> rays;
        choose_gap_rays(seen.covered, k, 5, rays);
        int bits = seen.covered.count();
        for (const GapRay& ray : rays) {
            bits += ray.bits;
            EXPECT_FALSE(seen.covered.test(ray.x, ray.y));
            EXPECT_TRUE(ray.x / k * k == ray.cell_x && ray.y / k * k == ray.cell_y);
        }
        EXPECT_EQ(bits, mask_bits);  // with the solid angle of a bit: covered + gaps = 2π
    }
}

TEST(GapFill,
     DrawsUniformlyAmongTheOpenBits) {  // χ² over the 12 open bits of one cell, 12,000 draws, 6 σ of a count
    Mask covered = ~Mask{};
    covered.rows[8] = covered.rows[8] & ~bit_span(12, 16);
    covered.rows[10] = covered.rows[10] & ~bit_span(12, 16);
    covered.rows[11] = covered.rows[11] & ~bit_span(12, 16);
    std::array<int, 16> drawn{};
    for (std::uint64_t key = 0; key < 12'000; ++key) {
        std::vector<GapRay> rays;
        choose_gap_rays(covered, 4, key, rays);
        ASSERT_EQ(rays.size(), 1u);
        ++drawn[static_cast<std::size_t>((rays[0].y - 8) * 4 + rays[0].x - 12)];
    }
    for (std::size_t i = 0; i < 16; ++i)
        EXPECT_NEAR(drawn[i], i / 4 == 1 ? 0 : 1000, i / 4 == 1 ? 0 : 6 * 30.3) << i;
}

ReceiverBsdf glossy() {
    ReceiverBsdf b;
    b.diffuse = {0.5f, 0.3f, 0.1f};
    b.coat_f0 = b.specular_f0 = Spectrum{0.04f};
    b.coat_f90 = b.specular_f90 = Spectrum{1};
    b.coated = b.specular = true;
    b.ggx.alpha = 0.1f;
    b.w_out = {normalize({0.5f, 0.2f, 0.6f})};
    b.shading_x = {1, 0, 0};
    b.shading_y = {0, 1, 0};
    b.shading_z = {0, 0, 1};
    return b;
}

TEST(GapFill, UnderLightThatIsOneEverywhereTheEstimateIsTheAlbedo) {
    const Spectrum one{1};
    const Stage stage(
        {{{-20, -20, -4}, {40, 0, 0}, {0, 60, 0}, one}, {{-0.5f, 0.4f, -1}, {1, 0, 0}, {0, 0.3f, 0}, one}},
        one);
    const Record record = stage.record({}, up);
    const Receiver receiver = receiver_at(record, {0.3f, 0, 0.1f}, {0.1f, 1, 0.05f});
    Reprojection seen = reprojected(record, receiver);
    ASSERT_GT(seen.gaps(), 100);
    RayCounts counts;
    std::vector<GapRay> rays;
    fill_gaps(stage.source(), {receiver.position, receiver.frame, 1e-5f, 0}, 4, 9, seen, rays, counts);
    EXPECT_EQ(counts.by_purpose[static_cast<std::size_t>(RayPurpose::gap)], rays.size());
    EXPECT_EQ(seen.gaps(), 0);
    BsdfTable table;
    tabulate(glossy(), all_cells, table);
    Reprojection ones;
    ones.clear(false);
    ones.lit = ~Mask{};
    std::fill_n(ones.radiance.begin(), mask_bits, pack_rgbe(one));
    EXPECT_EQ(shade(seen, table).total, shade(ones, table).total);
}

void expect_close(Spectrum found, Spectrum expected, float tolerance) {
    EXPECT_GT(expected.b, 1e-3f);
    EXPECT_NEAR(found.r, expected.r, tolerance * expected.r);
    EXPECT_NEAR(found.g, expected.g, tolerance * expected.g);
    EXPECT_NEAR(found.b, expected.b, tolerance * expected.b);
}

Reprojection lit_by_one(const BitRect& window) {
    Reprojection incident;
    incident.clear(false);
    std::fill_n(incident.radiance.begin(), mask_bits, pack_rgbe(Spectrum{1}));
    incident.lit.fill(window);
    return incident;
}

constexpr BitRect whole_square{0, 128, 0, 128};
constexpr std::array<BitRect, 3> windows{whole_square, {30, 61, 0, 128}, {0, 61, 38, 63}};

TEST(Shade, ATableOfWhatIsLitServesAsWellAsAWholeOne) {
    ReceiverBsdf sharp = glossy();
    sharp.ggx.alpha = 0.05f;
    BsdfTable whole, of_lit;
    tabulate(sharp, all_cells, whole);
    ASSERT_GT(whole.fine_cells.size(), 20u);
    for (const BitRect& window : windows) {
        const Reprojection incident = lit_by_one(window);
        expect_close(shade(incident, sharp, of_lit).total, shade(incident, whole).total, 2e-3f);
    }
    EXPECT_LT(of_lit.fine_cells.size(), whole.fine_cells.size());
}

TEST(Shade, TilesServeWideLobesAsWellAsCells) {
    ReceiverBsdf wide = glossy(), diffuse = wide;
    wide.ggx.alpha = 0.4f;
    diffuse.coated = diffuse.specular = false;
    for (const BitRect& window : windows)  // whose edges cut tiles
        for (const ReceiverBsdf& bsdf : {wide, diffuse}) {
            const Reprojection incident = lit_by_one(window);
            BsdfTable table, unused;
            tabulate(bsdf, all_cells, table);
            const bool is_linear = !bsdf.specular && window == whole_square;
            expect_close(shade(incident, bsdf, unused).total, shade(incident, table).total,
                         is_linear ? 1e-5f : 3e-3f);
            EXPECT_TRUE(unused.r.empty());
        }
}

TEST(ReceiverFrame, TurnsAsLittleAsItCan) {
    const Frame frame = frame_around(normalize({0.2f, 1, -0.3f}));
    EXPECT_EQ(receiver_frame(frame, frame.n).s, frame.s);
    const Vec3 n = normalize({0.3f, 1, -0.1f});
    const Frame turned = receiver_frame(frame, n);
    EXPECT_NEAR(dot(turned.s, turned.t), 0, 1e-6);
    EXPECT_NEAR(dot(turned.s, n), 0, 1e-6);
    EXPECT_NEAR(length(turned.t), 1, 1e-6);
    const Vec3 axis = normalize(cross(frame.n, n));  // stays where it is
    const LocalDir before = frame.to_local({axis}), after = turned.to_local({axis});
    EXPECT_NEAR(length(before.v - after.v), 0, 1e-5);
}

}  // namespace
}  // namespace relumine
