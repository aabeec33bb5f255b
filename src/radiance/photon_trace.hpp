// SPDX-License-Identifier: Apache-2.0
// Photons: light followed from lamps through mirrors, glass and sharp lobes to the surfaces that it lights.
#pragma once

#include <functional>
#include <vector>

#include "base/ray_counts.hpp"
#include "radiance/transport.hpp"
#include "shading/reflectance.hpp"

namespace relumine {

/// Lobes sharper than this (GGX α) hand photons on, as mirrors and glass do.
inline constexpr float caustic_alpha = 0.095f;

/// Whether the lobes of a surface do.
[[nodiscard]] bool is_caustic_lobe(const LobeSplit& split);

/// Light that arrives at a surface after at least one specular reflection or refraction.
struct Photon {
    Vec3 position;
    Vec3 normal;             // geometric, unit, on the side that the light comes from
    Vec3 from;               // unit, towards where it comes from
    Spectrum flux;           // W
    std::uint32_t specular;  // scattering vertices before this one
};

struct PhotonSettings {
    std::uint32_t paths = 1u << 18;             // that begin at lights
    std::uint32_t most_specular = 0xffffffffu;  // scattering vertices of a path before its end
    std::uint64_t seed = 0;
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon. May be empty
};

/// Whether anything in the scene hands photons on.
[[nodiscard]] bool has_specular_surfaces(const SceneData& scene);

/// The photons in the order of their paths: a function of scene and settings, whatever the number of threads.
/// Paths begin at points on specular surfaces that draw a light, so that none is wasted on what it cannot
/// meet.
[[nodiscard]] std::vector<Photon> trace_photons(const Transport& t, const PhotonSettings& settings,
                                                RayCounts& rays);

}  // namespace relumine
