// SPDX-License-Identifier: Apache-2.0
// Projection and drawing against their scalar definitions, on every instruction set that this machine has;
// built a second time with one lane alone (tests/CMakeLists.txt).
#include <gtest/gtest.h>
#include <half.h>

#include "base/rgbe.hpp"
#include "cache/draw_kernel.hpp"
#include "cache/hemisphere_map.hpp"
#include "cache/project_kernel.hpp"
#include "cache/test_random.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;
using testing::random_direction;
using testing::uniform;

/// Surfels as records have them: quads of a few texels, near and far, some of them under the horizon.
Surfels random_surfels(std::size_t count) {
    Surfels s;
    s.count = s.stride = count;
    s.scale = 0.01f;
    s.corners.resize(corner_planes * count + surfel_padding);
    s.texels.resize(count + surfel_padding);
    s.layer_begin = {0, static_cast<std::uint32_t>(count), static_cast<std::uint32_t>(count)};
    for (std::size_t i = 0; i < count; ++i) {
        const auto texel = [&](std::uint64_t what, int most) {
            return static_cast<std::uint8_t>(uniform(i, what, 0, static_cast<float>(most)));
        };
        s.texels[i] = {texel(1, 56), texel(2, 56), static_cast<std::uint8_t>(1 + texel(3, 8)),
                       static_cast<std::uint8_t>(1 + texel(4, 8))};
        const float distance = std::exp(uniform(i, 5, -1, 6));
        for (std::size_t corner = 0; corner < 4; ++corner) {
            const TexelRect& t = s.texels[i];
            const Point2 p{static_cast<float>(t.u + (corner % 2) * t.width) / 64,
                           static_cast<float>(t.v + (corner / 2) * t.height) / 64};
            const Vec3 offset = square_to_hemisphere(p).v * (distance * uniform(i, 6 + corner, 0.8f, 1.2f));
            for (std::size_t axis = 0; axis < 3; ++axis)
                s.corners[(3 * corner + axis) * s.stride + i] = half(offset[static_cast<int>(axis)]).bits();
        }
    }
    return s;
}

struct Box {
    float x0, x1, y0, y1;
};

struct ScalarProjection {
    BitRect mask, trail;
};

std::uint8_t first_bit(float edge) {
    return static_cast<std::uint8_t>(std::min(std::max(std::ceil(edge - 0.5f), 0.0f), float{mask_side}));
}

BitRect rounded(const Box& b) { return {first_bit(b.x0), first_bit(b.x1), first_bit(b.y0), first_bit(b.y1)}; }

struct Corner {
    float x, y, cosine;
};

/// The kernel's operations one by one; hemisphere_to_square up to its shorter polynomial.
Corner project_corner(Vec3 w) {
    const float length = std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z), ax = std::abs(w.x), ay = std::abs(w.y);
    const float major = std::max(std::max(ax, ay), length * 1e-12f);
    const float inverse = 1 / std::max(length * major, 1e-37f), cosine = w.z * (major * inverse);
    const float r = std::sqrt(std::max(0.0f, 1 - cosine));
    const float across =
        r * octant(std::min(std::min(ax, ay) * (length * inverse), 1.0f), short_octant_polynomial);
    const auto bits = [](float magnitude, float sign) { return 64 * std::copysign(magnitude, sign) + 64; };
    return {bits(ax >= ay ? r : across, w.x), bits(ax >= ay ? across : r, w.y), cosine};
}

Box bounds(const std::array<Corner, 4>& p) {
    const auto [x0, x1] = std::minmax({p[0].x, p[1].x, p[2].x, p[3].x});
    const auto [y0, y1] = std::minmax({p[0].y, p[1].y, p[2].y, p[3].y});
    return {x0, x1, y0, y1};
}

ScalarProjection project_one(const Surfels& s, std::size_t i, const Projection& projection) {
    std::array<Corner, 4> now;
    Vec3 middle;
    const Vec3 shift = projection.shift / s.scale;
    for (std::size_t c = 0; c < 4; ++c) {
        const auto plane = [&](std::size_t axis) {
            half h;
            h.setBits(s.corners[(3 * c + axis) * s.stride + i]);
            return static_cast<float>(h);
        };
        const Vec3 p{plane(0), plane(1), plane(2)};
        const Vec3 q = projection.rotated ? projection.turn.to_local({p}).v : p;
        now[c] = project_corner(q + shift);
        middle = middle + q;
    }
    const TexelRect& t = s.texels[i];
    const float per_texel = static_cast<float>(mask_side) / static_cast<float>(projection.side);
    const Box texels{t.u * per_texel, t.u * per_texel + t.width * per_texel, t.v * per_texel,
                     t.v * per_texel + t.height * per_texel};
    const Box mask = bounds(now);
    const Corner m = project_corner(middle);
    const float width = (texels.x1 - texels.x0) * 0.5f, height = (texels.y1 - texels.y0) * 0.5f;
    const Box old = projection.rotated ? Box{m.x - width, m.x + width, m.y - height, m.y + height} : texels;
    const bool above = std::max({now[0].cosine, now[1].cosine, now[2].cosine, now[3].cosine}) > 0;
    const bool faces =
        (now[1].x - now[2].x) * (now[3].y - now[0].y) - (now[1].y - now[2].y) * (now[3].x - now[0].x) > 0;
    const auto allowed = [](float low, float high) { return (high - low) * largest_growth + growth_margin; };
    const bool fits = mask.x1 - mask.x0 <= allowed(texels.x0, texels.x1)
                      && mask.y1 - mask.y0 <= allowed(texels.y0, texels.y1);
    const Box both{std::min(old.x0, mask.x0), std::max(old.x1, mask.x1), std::min(old.y0, mask.y0),
                   std::max(old.y1, mask.y1)};
    return {above && faces && fits ? rounded(mask) : BitRect{}, rounded(above ? both : old)};
}

TEST(ProjectKernel, HasTheBitsOfItsDefinitionOnEveryTarget) {
    on_every_target([] {
        int drawn = 0;
        for (const std::size_t count :
             {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{16}, std::size_t{333}}) {
            const Surfels s = random_surfels(count);
            std::vector<BitRect> masks(count + surfel_padding), trails(count + surfel_padding);
            for (std::uint64_t pose = 0; pose < 20; ++pose) {
                const Vec3 normal = normalize(Vec3{0, 0, 1} + random_direction(pose, 20) * 0.2f);
                const Projection p{frame_around(normal),
                                   random_direction(pose, 30) * uniform(pose, 40, 0, 0.5f), pose % 2 == 0,
                                   64};
                project_surfels(s, 0, count, p, masks, trails);
                for (std::size_t i = 0; i < count; ++i) {
                    const ScalarProjection expected = project_one(s, i, p);
                    ASSERT_EQ(masks[i], expected.mask) << i;
                    ASSERT_EQ(trails[i], expected.trail) << i;
                    drawn += !masks[i].empty();
                }
            }
        }
        EXPECT_GT(drawn, 1000);
    });
}

TEST(ProjectKernel, AgreesWithTheMap) {
    for (std::uint64_t i = 0; i < 1000; ++i) {
        const LocalDir w{random_direction(i, 1)};
        const Point2 p = hemisphere_to_square(w);
        const Corner c = project_corner(w.v * uniform(i, 2, 0.1f, 10));
        EXPECT_NEAR(c.x, p.x * mask_side, 0.01);
        EXPECT_NEAR(c.y, p.y * mask_side, 0.01);
    }
}

struct Drawing {
    Mask open, lit;
    std::vector<std::uint32_t> radiance = std::vector<std::uint32_t>(mask_bits + surfel_padding);
    std::vector<std::uint32_t> direct = std::vector<std::uint32_t>(mask_bits + surfel_padding);
};

void draw_one(const BitRect& rect, const TexelRect& texels, bool black, const RecordTexture& texture,
              Drawing& out) {
    const TexelSteps columns(texels.width, static_cast<std::uint32_t>(rect.width())),
        rows(texels.height, static_cast<std::uint32_t>(rect.height()));
    for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < rect.x1; ++x) {
            if (!out.open.test(x, y)) continue;
            const std::uint32_t v = texels.v + rows(static_cast<std::uint32_t>(y - rect.y0)),
                                u = texels.u + columns(static_cast<std::uint32_t>(x - rect.x0));
            const auto at = static_cast<std::size_t>(y * mask_side + x);
            out.radiance[at] = black ? 0 : texture.radiance[v * texture.side + u];
            out.direct[at] = black ? 0 : texture.direct[v * texture.side + u];
            Mask bit;
            bit.fill({static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(x + 1),
                      static_cast<std::uint8_t>(y), static_cast<std::uint8_t>(y + 1)});
            out.open = out.open & ~bit;
            if (!black) out.lit = out.lit | bit;
        }
}

/// Bit by bit, the texels that were missed.
void draw_missed_one(const BitRect& rect, const TexelRect& texels, const RecordTexture& texture,
                     Drawing& out) {
    const TexelSteps columns(texels.width, static_cast<std::uint32_t>(rect.width())),
        rows(texels.height, static_cast<std::uint32_t>(rect.height()));
    for (int y = rect.y0; y < rect.y1; ++y)
        for (int x = rect.x0; x < rect.x1; ++x) {
            const std::uint32_t v = texels.v + rows(static_cast<std::uint32_t>(y - rect.y0)),
                                u = texels.u + columns(static_cast<std::uint32_t>(x - rect.x0));
            const std::size_t texel = v * texture.side + u;
            const auto byte = [](int i) { return static_cast<std::uint8_t>(i); };
            if ((texture.missed[texel / 8] >> texel % 8 & 1) != 0)
                draw_one({byte(x), byte(x + 1), byte(y), byte(y + 1)},
                         {byte(static_cast<int>(u)), byte(static_cast<int>(v)), 1, 1}, false, texture, out);
        }
}

std::uint8_t random_byte(std::uint64_t i, std::uint64_t what, float low, float high) {
    return static_cast<std::uint8_t>(uniform(i, what, low, high));
}

/// Anywhere in the square, also at its last rows and columns, and empty ones.
BitRect random_rect(std::uint64_t i, float widest, float highest) {
    const std::uint8_t x0 = random_byte(i, 1, 0, 128), y0 = random_byte(i, 2, 0, 128);
    return {x0, static_cast<std::uint8_t>(std::min(128.0f, x0 + uniform(i, 3, 0, widest))), y0,
            static_cast<std::uint8_t>(std::min(128.0f, y0 + uniform(i, 4, 0, highest)))};
}

TEST(DrawKernel, HasTheBitsOfItsDefinitionOnEveryTarget) {
    constexpr std::size_t side = 64, count = 120, colored = 90;
    std::vector<std::uint32_t> texture(side * side + surfel_padding), direct = texture;
    for (std::size_t i = 0; i < side * side; ++i) {
        texture[i] = static_cast<std::uint32_t>(hash(i, 1)) | 1;
        direct[i] = static_cast<std::uint32_t>(hash(i, 2)) | 1;
    }
    const RecordTexture record{texture, direct, side, {}};
    std::vector<BitRect> masks;
    std::vector<TexelRect> texels;
    for (std::uint64_t i = 0; i < count; ++i) {
        masks.push_back(random_rect(i, i % 4 == 0 ? 128.0f : i % 4 == 1 ? 5.0f : 20.0f, 22));
        const bool dot = i % 3 == 0;
        texels.push_back({random_byte(i, 5, 0, 56), random_byte(i, 6, 0, 56),
                          dot ? std::uint8_t{1} : random_byte(i, 7, 1, 9),
                          dot ? std::uint8_t{1} : random_byte(i, 8, 1, 9)});
    }
    masks[7] = {};
    masks.resize(count + surfel_padding);
    Drawing expected;
    expected.open.fill({3, 120, 5, 128});
    const int open_before = expected.open.count();
    for (std::size_t i = 0; i < count; ++i) draw_one(masks[i], texels[i], i >= colored, record, expected);
    ASSERT_GT(open_before - expected.open.count(), mask_bits / 3);
    on_every_target([&] {
        for (const bool with_direct : {false, true}) {
            Drawing out;
            out.open.fill({3, 120, 5, 128});
            SplitMask open(out.open), lit;
            const Canvas canvas{open, lit, out.radiance,
                                with_direct ? std::span(out.direct) : std::span<std::uint32_t>()};
            EXPECT_TRUE(draw_surfels(std::span(masks).first(count), {texels, colored}, record, canvas));
            EXPECT_EQ(open.joined(), expected.open);
            EXPECT_EQ(lit.joined(), expected.lit);
            EXPECT_EQ(out.radiance, expected.radiance);
            EXPECT_TRUE(!with_direct || out.direct == expected.direct);
            EXPECT_FALSE(draw_surfels(std::span(masks).first(0), {texels, 0}, record, canvas));
            EXPECT_FALSE(draw_surfels(std::span(masks).first(count), {texels, colored}, record,
                                      canvas));  // nothing is open there now
        }
    });
}

TEST(DrawKernel, DrawsOnlyWhatWasMissedOnEveryTarget) {
    constexpr std::size_t side = 64, count = 60;
    std::vector<std::uint32_t> texture(side * side + surfel_padding), direct = texture;
    std::vector<std::uint8_t> missed(side * side / 8);
    for (std::size_t i = 0; i < side * side; ++i) {
        texture[i] = static_cast<std::uint32_t>(hash(i, 1));
        direct[i] = static_cast<std::uint32_t>(hash(i, 2));
    }
    for (std::size_t i = 0; i < missed.size(); ++i) missed[i] = static_cast<std::uint8_t>(hash(i, 3));
    std::vector<BitRect> masks;
    std::vector<TexelRect> texels;
    for (std::uint64_t i = 0; i < count; ++i) {
        masks.push_back(random_rect(i, 30, 30));
        const std::uint8_t u = random_byte(i, 5, 0, 64), v = random_byte(i, 6, 0, 56);
        texels.push_back({u, v, static_cast<std::uint8_t>(uniform(i, 7, 1, 9.0f - static_cast<float>(u % 8))),
                          random_byte(i, 8, 1, 9)});
    }
    Drawing expected;
    expected.open.fill({3, 120, 5, 128});
    const int open_before = expected.open.count();
    for (std::size_t i = 0; i < count; ++i)
        draw_missed_one(masks[i], texels[i], {texture, direct, side, missed}, expected);
    ASSERT_GT(open_before - expected.open.count(), mask_bits / 8);
    on_every_target([&] {
        for (const bool with_direct : {false, true}) {
            Drawing out;
            out.open.fill({3, 120, 5, 128});
            SplitMask open(out.open), lit;
            const Canvas canvas{open, lit, out.radiance,
                                with_direct ? std::span(out.direct) : std::span<std::uint32_t>()};
            EXPECT_TRUE(draw_missed(masks, texels, {texture, direct, side, missed}, canvas));
            EXPECT_EQ(open.joined(), expected.open);
            EXPECT_EQ(lit.joined(), expected.lit);
            EXPECT_EQ(out.radiance, expected.radiance);
            EXPECT_TRUE(!with_direct || out.direct == expected.direct);
        }
    });
}

TEST(DrawKernel, CopiesWhatWasMissedOnEveryTarget) {
    for (const std::size_t side : {16u, 32u, 64u, 128u}) {
        std::vector<std::uint32_t> texture(side * side + surfel_padding), direct = texture;
        std::vector<std::uint8_t> missed(side * side / 8);
        for (std::size_t i = 0; i < side * side; ++i) {
            texture[i] = static_cast<std::uint32_t>(hash(i, 1));
            direct[i] = static_cast<std::uint32_t>(hash(i, 2));
        }
        for (std::size_t i = 0; i < missed.size(); ++i)  // whole bytes too, and rows that were hit
            missed[i] =
                i / 7 % 3 == 0 ? std::uint8_t{0} : static_cast<std::uint8_t>(hash(i, 3) | (i % 2) * 255);
        Drawing expected;
        expected.open.fill({3, 120, 5, 128});
        const auto byte = [](std::size_t i) { return static_cast<std::uint8_t>(i); };
        const std::size_t scale = mask_side / side;
        for (std::size_t v = 0; v < side; ++v)
            for (std::size_t u = 0; u < side; ++u)
                draw_missed_one(
                    {byte(u * scale), byte((u + 1) * scale), byte(v * scale), byte((v + 1) * scale)},
                    {byte(u), byte(v), 1, 1}, {texture, direct, side, missed}, expected);
        on_every_target([&] {
            for (const bool with_direct : {false, true}) {
                Drawing out;
                out.open.fill({3, 120, 5, 128});
                SplitMask open(out.open), lit;
                const Canvas canvas{open, lit, out.radiance,
                                    with_direct ? std::span(out.direct) : std::span<std::uint32_t>()};
                EXPECT_TRUE(copy_missed({texture, direct, side, missed}, canvas));
                EXPECT_EQ(open.joined(), expected.open);
                EXPECT_EQ(lit.joined(), expected.lit);
                EXPECT_EQ(out.radiance, expected.radiance);
                EXPECT_TRUE(!with_direct || out.direct == expected.direct);
                EXPECT_FALSE(copy_missed({texture, direct, side, missed}, canvas));
            }
        });
    }
}

TEST(DrawKernel, ClosesTrailsOnEveryTarget) {
    std::vector<BitRect> trails;
    Mask open = ~Mask{}, unknown, closed_before, expected_closed;
    open.rows[40] = open.rows[41] = {};
    unknown.fill({0, 9, 0, 9});
    closed_before.fill({100, 120, 90, 110});
    open = open & ~closed_before;
    expected_closed = closed_before;
    for (std::uint64_t i = 0; i < 30; ++i) {
        trails.push_back(random_rect(i, 50, 40));
        expected_closed.fill(trails.back());
    }
    trails.resize(30 + surfel_padding);
    const Mask expected_unknown = unknown | (expected_closed & open), expected_open = open & ~expected_closed;
    ASSERT_GT(expected_unknown.count(), 1000);
    on_every_target([&] {
        SplitMask now_open(open), now_unknown(unknown), closed(closed_before);
        close_trails(std::span(trails).first(30), closed, now_open, now_unknown);
        EXPECT_EQ(now_open.joined(), expected_open);
        EXPECT_EQ(now_unknown.joined(), expected_unknown);
        EXPECT_EQ(closed.joined(), expected_closed);
    });
}

TEST(DrawKernel, SplitsAndJoinsMasksOnEveryTarget) {
    Mask mask;
    for (std::uint64_t i = 0; i < 40; ++i) mask.fill(random_rect(i, 90, 9));
    on_every_target([&] {
        EXPECT_EQ(rest_of(mask).joined(), ~mask);
        Mask joined;
        join(SplitMask(mask), joined);
        EXPECT_EQ(joined, mask);
    });
}

}  // namespace
}  // namespace relumine
