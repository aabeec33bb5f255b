// SPDX-License-Identifier: Apache-2.0
// The radiance source of gather rays: what they bring back from where they land.
#pragma once

#include <string>

#include "radiance/path.hpp"

namespace relumine {

/// Which light gather rays bring back.
struct IncidentRadiance {
    const Transport& transport;
    std::uint32_t max_depth = unlimited_depth;     // scattering vertices of a whole path
    std::uint32_t source_depth = unlimited_depth;  // those among them behind the gather ray
    const RadianceField* field = nullptr;  // asked for what surfaces reflect, instead of following paths

    /// Whether surfaces that the rays hit reflect anything: false for the source `emission`.
    [[nodiscard]] bool reflects() const { return source_depth > 0; }
};

/// How many scattering vertices behind the gather ray's hit the source of this name adds.
[[nodiscard]] std::uint32_t source_depth(const std::string& radiance);

/// The incident radiance along rays that were traced already: `direct` from lights that they meet, `indirect`
/// reflected by surfaces that they hit. `depth`: scattering vertices up to and including the one that the
/// rays leave. Rays with t_max < 0 are left out. The same sixteen must always go together.
[[nodiscard]] RadiancePacket incident_radiance(const IncidentRadiance& source,
                                               const std::array<Ray, packet_size>& rays,
                                               const std::array<Hit, packet_size>& hits, std::uint32_t depth,
                                               const StreamPacket& streams, RayCounts& counts);

}  // namespace relumine
