// SPDX-License-Identifier: Apache-2.0
// What elements of a radiance field see of each other, and the light that goes back and forth along it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/frame.hpp"
#include "radiance/field_cells.hpp"
#include "radiance/field_solver.hpp"

namespace relumine {

/// One ray of an element and the element that it has met.
struct Link {
    ElementId to = 0;
    std::uint16_t ray = 0;                      // of the element that it belongs to
    std::uint16_t direction = 0;                // that it arrives from, see pack_direction
    std::array<std::uint16_t, 3> throughput{};  // in units of 1 / 1024, rounded up or down by chance
    std::uint8_t lobes = 0;                     // reflections along lobes on the way

    [[nodiscard]] Spectrum value() const;
};
static_assert(sizeof(Link) == 16);
[[nodiscard]] Link make_link(ElementId to, std::uint16_t ray, std::uint16_t direction, Spectrum throughput,
                             std::uint8_t lobes);

/// A direction above the surface, in the frame around an element's normal, to within half a degree.
[[nodiscard]] std::uint16_t pack_direction(LocalDir w);
[[nodiscard]] LocalDir unpack_direction(std::uint16_t packed);

/// The links of all elements: E = light + Σ throughput · E(to) / rays, per element.
struct FieldLinks {
    std::vector<Link> links;
    std::vector<std::size_t> first{0};  // per element, and the end

    [[nodiscard]] std::span<const Link> of(std::size_t element) const {
        return {links.data() + first[element], first[element + 1] - first[element]};
    }
    void end_element() { first.push_back(links.size()); }
};

/// What arrives at elements from lights.
struct ElementLight {
    std::vector<Spectrum> straight;
    std::vector<Spectrum> reflected;  // by a lobe, once for all that is known
};

/// How light has grown, reflection by reflection.
struct Reflections {
    std::vector<double> totals;  // of what arrives after none, one, … of them, over all elements
    std::size_t limit = 0;
    std::size_t at_once = 0;  // further ones, whose sum alone is known

    [[nodiscard]] std::size_t computed() const { return totals.size() - 1 + at_once; }
    /// Of all the irradiance, what a limit that is lower by so many would leave.
    [[nodiscard]] float share_without(std::size_t reflections) const;
};

/// Irradiance after `bounces` further reflections, those of lobes on links' ways included, or until it no
/// longer changes (0.01 %). `share`: one over the rays of an element.
Reflections iterate(const FieldLinks& links, const ElementLight& light, float share, std::uint32_t bounces,
                    int threads, std::vector<Spectrum>& irradiance);

}  // namespace relumine
