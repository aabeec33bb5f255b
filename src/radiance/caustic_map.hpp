// SPDX-License-Identifier: Apache-2.0
// The caustic map: photons found by place [Jensen96], for the light that mirrors, glass and sharp lobes throw
// onto surfaces, which rays from there find by chance alone.
#pragma once

#include <memory>

#include "radiance/field_trace.hpp"
#include "radiance/photon_trace.hpp"

namespace relumine {

/// While a transport has a caustic map, what meets light through specular vertices alone, seen from a surface
/// that scatters, is left out of gather rays and the radiance field: the map has all of it.
class CausticMap {
  public:
    explicit CausticMap(std::vector<Photon> photons);
    ~CausticMap();

    /// What the surface reflects towards the viewer of light that has met up to `most_specular` vertices:
    /// photons near by under a compact kernel, within a distance that shrinks as there are more of them.
    [[nodiscard]] Spectrum reflected(const Vertex& vertex, std::uint32_t most_specular) const;

    /// Adds the mean of the light that arrives in an element's cell, around some of the `points` there.
    void add_arriving(const FieldElement& element, std::span<const StartPoint> points,
                      std::uint32_t most_specular, IrradianceVector& light) const;

    [[nodiscard]] const std::vector<Photon>& photons() const;
    [[nodiscard]] std::size_t bytes() const;

  private:
    struct Impl;
    void add_around(Vec3 position, Vec3 normal, float radius, std::uint32_t most_specular, float share,
                    IrradianceVector& light) const;
    std::unique_ptr<Impl> impl_;
};

/// CausticMap::reflected at a vertex with `depth` scattering vertices before it; 0 where there is no map.
[[nodiscard]] Spectrum caustic_light(const Transport& t, const Vertex& vertex, std::uint32_t depth,
                                     std::uint32_t max_depth);

}  // namespace relumine
