// SPDX-License-Identifier: Apache-2.0
// Where the light of a radiance field's elements comes from.
#pragma once

#include <span>
#include <vector>

#include "radiance/arrival_map.hpp"
#include "radiance/field_links.hpp"

namespace relumine {

/// A ray that has met nothing but the sky.
struct Sight {
    Vec3 direction;        // unit, turned as the element is
    float irradiance = 0;  // luminance, W·m⁻²
};

/// What elements receive straight from lights, one after the other; luminance, W·m⁻².
class StraightLight {
  public:
    /// The next element: `light` in all, `sky` without what light samples find.
    void add(Vec3 normal, float light, std::span<const Sight> sky);
    /// So many elements in all; the others, of a stopped build, receive nothing.
    void resize(std::size_t elements);

    [[nodiscard]] float of(std::size_t element) const { return lights_[element]; }
    /// By cell of the element's ArrivalMap.
    [[nodiscard]] std::span<const float> sky_of(std::size_t element) const {
        return std::span(sky_).subspan(element * ArrivalMap::cells, ArrivalMap::cells);
    }

  private:
    std::vector<float> lights_, sky_;
};

/// Of an element: see PlacedArrivals.
struct ElementArrivals {
    ArrivalMap surfaces, sky;
    float sky_share = 0;
};

/// Those of each element and of those around it in its plane: the rays of one are few. `irradiance`, `share`:
/// as of iterate().
[[nodiscard]] std::vector<ElementArrivals> make_arrivals(const FieldCells& cells, const FieldLinks& links,
                                                         std::span<const Spectrum> irradiance, float share,
                                                         const StraightLight& straight, int threads);

}  // namespace relumine
