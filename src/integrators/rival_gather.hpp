// SPDX-License-Identifier: Apache-2.0
// `irradiance-cache` and `radiance-cache`: the caches that the paper is to be compared with (docs/rivals.md).
#pragma once

#include <memory>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// Diffuse light from irradiance records with gradients [Ward88, Ward92, Krivanek09]; lobes by rays.
[[nodiscard]] std::unique_ptr<Integrator> make_irradiance_cache(const RenderSettings& settings,
                                                                const Transport& transport, const View& view,
                                                                bool surface_layers);

/// The same for diffuse surfaces, and radiance records in harmonics for those with broad lobes [Krivanek05].
[[nodiscard]] std::unique_ptr<Integrator> make_radiance_cache(const RenderSettings& settings,
                                                              const Transport& transport, const View& view,
                                                              bool surface_layers);

}  // namespace relumine
