// SPDX-License-Identifier: Apache-2.0
// `reproject` and `reproject-mc`: the paper's two methods, final gather from records [V].
#pragma once

#include <memory>

#include "base/hash.hpp"
#include "cache/placement.hpp"
#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// What settings ask of the cache.
[[nodiscard]] CacheSettings cache_settings(const RenderSettings& settings);

/// The pixels that decide which records the view's window has in the pass from `first_sample` on.
[[nodiscard]] PixelRect placement_region(const View& view, std::uint32_t first_sample);

/// What decides the rays through the gaps that records leave at a point.
[[nodiscard]] inline std::uint64_t gap_key(const CachePoint& point) { return hash(point.key, 1); }

/// Records reprojected, gaps filled: fast and slightly biased.
[[nodiscard]] std::unique_ptr<Integrator> make_reproject(const RenderSettings& settings,
                                                         const Transport& transport, const View& view,
                                                         bool surface_layers);

/// As many rays more as settings say, drawn from what reprojection has found: unbiased as long as a share of
/// them is drawn from the BSDF.
[[nodiscard]] std::unique_ptr<Integrator> make_reproject_mc(const RenderSettings& settings,
                                                            const Transport& transport, const View& view,
                                                            bool surface_layers);

}  // namespace relumine
