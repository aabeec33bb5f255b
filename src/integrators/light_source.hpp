// SPDX-License-Identifier: Apache-2.0
// Which light the methods that gather take from where their rays land, by the settings' `radiance`.
#pragma once

#include <memory>

#include "integrators/view.hpp"
#include "radiance/caustic_map.hpp"
#include "radiance/incident.hpp"
#include "radiance/radiance_field.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// What gather rays bring back: from `transport.field`, where there is one and the method may be biased, or
/// as the settings say.
[[nodiscard]] IncidentRadiance incident_source(const RenderSettings& settings, const Transport& transport);

/// Whether a method looks light up in a radiance field: `radiosity`, or `auto` where light is reflected more
/// than once; or lets one attract paths.
[[nodiscard]] bool wants_field(const RenderSettings& settings);

/// Whether that field attracts paths.
[[nodiscard]] bool wants_guide(const RenderSettings& settings);

/// The caustics that go with a field; null where the settings want none, the method is to be unbiased or
/// nothing in the scene is specular. `stop` may be empty.
[[nodiscard]] std::unique_ptr<CausticMap> make_caustics(const RenderSettings& settings,
                                                        const Transport& transport,
                                                        const std::function<bool()>& stop, RayCounts& rays);

/// Bytes without which no field is begun.
[[nodiscard]] std::uint64_t least_field_bytes();

/// The field of a scene as the camera's full frame sees it. Where it would take more than `most_bytes`, its
/// cells are made larger until it does not. `stop` may be empty.
[[nodiscard]] std::unique_ptr<RadianceField> make_field(const RenderSettings& settings,
                                                        const Transport& transport, const View& view,
                                                        const std::function<bool()>& stop,
                                                        std::uint64_t most_bytes, RayCounts& rays);

}  // namespace relumine
