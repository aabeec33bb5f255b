// SPDX-License-Identifier: Apache-2.0
// What a render will need of memory, as far as that is known before it begins.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "integrators/integrator.hpp"
#include "relumine/render.hpp"
#include "render_setup.hpp"

namespace relumine {

/// Bytes by what they are for.
using MemoryNeeds = std::vector<std::pair<std::string, std::uint64_t>>;

/// Program, scene, acceleration structure (estimated), film, picture and, where one is kept, checkpoint.
[[nodiscard]] MemoryNeeds needed_before_building(const Scene& scene, const RenderSettings& settings,
                                                 const Framing& framing, bool checkpoint);
/// The same, and what the method and the radiance field, if any, will hold.
[[nodiscard]] MemoryNeeds needed_with(const Integrator& integrator, const RadianceField* field,
                                      const Scene& scene, const RenderSettings& settings,
                                      const Framing& framing, bool checkpoint);

/// What a limit leaves beside these needs, or no_limit. They have been checked.
[[nodiscard]] std::uint64_t room_beside(const MemoryNeeds& needs, const RenderControl& control);

/// Throws Error with the bytes needed where the limit is below.
void check_memory(const RenderControl& control, const MemoryNeeds& needs);

}  // namespace relumine
