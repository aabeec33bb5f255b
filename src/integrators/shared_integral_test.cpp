// SPDX-License-Identifier: Apache-2.0
// What a shared integral gives a sample of another colour is what an integral of its own would.
#include "integrators/shared_integral.hpp"

#include <gtest/gtest.h>

#include "blocks/test_maps.hpp"

namespace relumine {
namespace {

using testing::MapStage;

/// A sample on the ground under a map that is brighter in the east.
class GroundUnderMap {
  public:
    GroundUnderMap()
        : stage_({}, testing::even_sky(Spectrum{1}), 32),
          points_(stage_.grid()),
          map_(testing::open_map(stage_.grid(), [&](std::size_t texel) {
              return Spectrum{
                  1 + stage_.grid().direction_in(static_cast<std::uint32_t>(texel), {0.5f, 0.5f}).v.x};
          })) {
        blend_.add(map_, 1);
        blend_.normalize();
        pixel_.cache.gather.frame = frame_around({0, 0, 1});
        pixel_.cache.footprint = 0.01f;
    }

    [[nodiscard]] LitSample sample(Spectrum diffuse, bool layered) const {
        LitSample s;
        s.pixel = &pixel_;
        s.bsdf.diffuse = diffuse;
        s.bsdf.specular = layered;
        s.bsdf.specular_f0 = Spectrum{0.04f};
        s.bsdf.specular_f90 = Spectrum{1};
        s.bsdf.ggx = {0.3f, Masking::correlated};
        s.bsdf.w_out = LocalDir{{0.6f, 0, 0.8f}};
        s.bsdf.shading_x = {1, 0, 0};
        s.bsdf.shading_y = {0, 1, 0};
        s.bsdf.shading_z = {0, 0, 1};
        return s;
    }

    /// What `to` gets of an integral for `from`, and how many times that its own is.
    LitSample given(const LitSample& from, LitSample to, Spectrum* scale = nullptr) {
        SharedIntegral shared({stage_.grid(), points_, stage_.environment(), false}, {true, true});
        shared.run(from, blend_);
        const Spectrum times = shared.give(1, to);
        if (scale) *scale = times;
        return to;
    }

    /// Of a blend with a map of three times the radiance that weighs `weight` times the other.
    float level_with(const LitSample& sample, float weight) {
        BlockMap bright = map_;
        for (float& value : bright.tile_luminance) value *= 3;
        Blend other;
        other.add(map_, 1);
        other.add(bright, weight);
        other.normalize();
        SharedIntegral shared({stage_.grid(), points_, stage_.environment(), false}, {true, true});
        shared.run(sample, blend_);
        return shared.level_under(other);
    }

  private:
    MapStage stage_;
    QuadraturePoints points_;
    BlockMap map_;
    Blend blend_;
    GBufferPixel pixel_;
};

/// Up to the quadrature, which follows the share of the lobe in what is reflected.
void expect_like(Spectrum found, Spectrum expected) {
    EXPECT_GT(luminance(expected), 0);
    EXPECT_NEAR(found.r, expected.r, 1e-3f);
    EXPECT_NEAR(found.g, expected.g, 1e-3f);
    EXPECT_NEAR(found.b, expected.b, 1e-3f);
}

TEST(SharedIntegral, GivesOtherColoursWhatTheirOwnWould) {
    GroundUnderMap ground;
    for (const bool layered : {false, true}) {
        const LitSample a = ground.sample({0.5f, 0.4f, 0.3f}, layered),
                        b = ground.sample({0.1f, 0.6f, 0.3f}, layered);
        Spectrum scale;
        const LitSample shared = ground.given(a, b, &scale), own = ground.given(b, b);
        expect_like(shared.reflected.direct, own.reflected.direct);
        expect_like(shared.albedo, own.albedo);
        expect_like(scale, layered ? Spectrum{1} : Spectrum{0.2f, 1.5f, 1});
        EXPECT_EQ(shared.maps, 1);
        EXPECT_GT(shared.deviation, 0);
    }
}

/// All lobes stay as they are where the diffuse part under them is of another colour.
TEST(SharedIntegral, GivesOtherColoursUnderLayersWhatTheirOwnWould) {
    GroundUnderMap ground;
    LitSample a = ground.sample({0.5f, 0.4f, 0.3f}, true), b = ground.sample({0.1f, 0.6f, 0.3f}, true);
    for (LitSample* sample : {&a, &b}) {
        OverLayers& over = sample->bsdf.over;
        over.clearcoat = over.clearcoat_lobe = 1;
        over.clearcoat_alpha = 0.2f;
        over.sheen = 0.5f;
        over.sheen_lobe = Spectrum{0.5f};
        over.sheen_alpha = 0.3f;
    }
    const LitSample shared = ground.given(a, b), own = ground.given(b, b);
    expect_like(shared.reflected.direct, own.reflected.direct);
    expect_like(shared.albedo, own.albedo);
}

TEST(SharedIntegral, TakesTheLevelOfAnotherBlend) {
    GroundUnderMap ground;
    const LitSample a = ground.sample({0.5f, 0.4f, 0.3f}, false);
    EXPECT_FLOAT_EQ(ground.level_with(a, 0), 1);
    EXPECT_NEAR(ground.level_with(a, 1), 2, 1e-5f);  // under a map of three times the radiance, half and half
    EXPECT_EQ(ground.level_with(a, 1e6f), 2);        // bounded
}

}  // namespace
}  // namespace relumine
