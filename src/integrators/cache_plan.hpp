// SPDX-License-Identifier: Apache-2.0
// What the wanted error means for the steps of `cache`.
#pragma once

#include "blocks/block_partition.hpp"
#include "integrators/residual_rays.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// The standard deviation of one residual ray, against MapIntegral::deviation(), that is expected.
inline constexpr float deviation_of_one = 0.75f;

/// How rays follow the expected error of a pixel; all counts are of all its samples together, powers of two.
struct RayDemand {
    bool residual_adapts = false, light_adapts = false;
    float sigma = 0;           // of a pixel, relative: that is aimed at
    float residual_gain = 1;   // how much better a pixel gets than its own residual rays make it
    float light_gain = 1;      // the same of light samples
    float least_residual = 1;  // whatever the maps' doubt
    float pilot = 0;           // light samples before anything is known

    /// For a pixel whose maps may be wrong by `doubt`, relative to what it shines: MapIntegral::deviation().
    [[nodiscard]] float residual_rays(float doubt) const;
    /// Beside `before`, which are these, for a pixel whose rays scatter so many times more than was expected:
    /// in proportion, not by the square, or few pixels would take most of a picture's time.
    [[nodiscard]] static float more_residual(float scatter, float before);
    /// Beside the pilot's, for a pixel whose pilot has a relative standard deviation of `noise`.
    [[nodiscard]] float more_light(float noise) const;
};

struct CachePlan {
    BlockSettings blocks;
    RayBudget rays;  // what is usual, or what was asked for
    RayDemand demand;
    float pixel_samples = 1;
    float sharp_alpha = 0;        // lobes below it are none of the maps' and left to rays of their own,
    float lobe_rays = 1;          // of which a camera sample has so many
    std::size_t reprojected = 0;  // records around that a map is filled with, beside its own
    bool exact = false, filters = false;
    bool blends = true;  // maps around a pixel; else the one that would weigh most lights it alone
};

/// At an error of 2 %: blocks with a parallax error of four fifths; in proportion. Rays as `demand` says,
/// unless their number was given.
[[nodiscard]] CachePlan cache_plan(const RenderSettings& settings);

/// For samples that no map serves (BSDFs that transmit, mostly): as many gather rays for a pixel as residual
/// rays where the maps know nothing, and a quarter of them as light samples unless their number was given.
[[nodiscard]] RenderSettings monte_carlo_settings(const RenderSettings& settings);

/// One map per block of 8 × 8 pixels and surface, and nothing else: what maps are worth without more.
[[nodiscard]] CachePlan block_gather_plan(const RenderSettings& settings);

}  // namespace relumine
