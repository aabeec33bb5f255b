// SPDX-License-Identifier: Apache-2.0
// `path`: the reference, unbiased path tracing.
#pragma once

#include <memory>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// `surface_layers`: whether the film wants albedo, normal, position, depth or material.
[[nodiscard]] std::unique_ptr<Integrator> make_path_tracer(const RenderSettings& settings,
                                                           const Transport& transport, const View& view,
                                                           bool surface_layers);

/// The path length that settings ask for.
[[nodiscard]] std::uint32_t depth_limit(const RenderSettings& settings);

}  // namespace relumine
