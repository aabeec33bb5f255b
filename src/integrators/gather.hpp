// SPDX-License-Identifier: Apache-2.0
// `gather`: the paper's Monte Carlo baseline, many BSDF-proportional rays from every shading point [V, §3.4].
#pragma once

#include <memory>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

[[nodiscard]] std::unique_ptr<Integrator> make_gather(const RenderSettings& settings,
                                                      const Transport& transport, const View& view,
                                                      bool surface_layers);

}  // namespace relumine
