// SPDX-License-Identifier: Apache-2.0
// The methods by name.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

[[nodiscard]] std::vector<std::string> integrator_names();

/// The method `settings.method`, which must be one of the names; settings are valid. References outlive the
/// integrator.
[[nodiscard]] std::unique_ptr<Integrator> make_integrator(const RenderSettings& settings,
                                                          const Transport& transport, const View& view,
                                                          bool surface_layers);

}  // namespace relumine
