// SPDX-License-Identifier: Apache-2.0
// `cache`: incident radiance kept in maps that blocks of pixels share, and rays for what the maps get wrong.
#pragma once

#include <memory>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

[[nodiscard]] std::unique_ptr<Integrator> make_block_cache(const RenderSettings& settings,
                                                           const Transport& transport, const View& view,
                                                           bool surface_layers);

/// `block-gather`: the maps alone, one per 8 × 8 pixels and surface, without residual rays; a rival for
/// benchmarks.
[[nodiscard]] std::unique_ptr<Integrator> make_block_gather(const RenderSettings& settings,
                                                            const Transport& transport, const View& view,
                                                            bool surface_layers);

}  // namespace relumine
