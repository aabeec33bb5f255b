// SPDX-License-Identifier: Apache-2.0
// Embree's filters for surfaces that rays may pass: partly transparent ones and panes.
#pragma once

#include "trace/embree.hpp"
#include "trace/tracer.hpp"

namespace relumine {

/// The product of transmittances per lane, in whichever order they come: a sum of binary logarithms in fixed
/// point, so that the order of traversal cannot change a bit.
class PassedLight {
  public:
    void multiply(std::size_t lane, Spectrum transmittance);
    /// 1 where nothing was multiplied.
    [[nodiscard]] Spectrum operator[](std::size_t lane) const;

  private:
    std::array<std::array<std::int64_t, 3>, packet_size> log2_{};  // times 2^32
};

/// What filters know of the rays that are traced. Their `id` in Embree is their lane.
struct Query {
    QueryContext embree;              // first: filters get a pointer to it
    const Ray* ray = nullptr;         // a single ray, or
    const RayLanes* lanes = nullptr;  // a packet
    PassedLight* light = nullptr;     // takes what passes, if wanted
    bool tints = false;               // that is, the colour of the panes that the nearest hit lies behind

    explicit Query(const Ray& single, PassedLight* passed = nullptr) : ray(&single), light(passed) {
        init_context(&embree);
    }
    explicit Query(const RayLanes& packet, PassedLight* passed = nullptr) : lanes(&packet), light(passed) {
        init_context(&embree);
    }

    [[nodiscard]] std::uint32_t opacity_seed(std::size_t lane) const {
        return lanes ? lanes->opacity_seed[lane] : ray->opacity_seed;
    }
    [[nodiscard]] WorldDir direction(std::size_t lane) const {
        return lanes ? WorldDir{lanes->direction[lane]} : ray->direction;
    }
};

/// The user data of a geometry with a filter.
struct FilterData {
    const OpacityFunction* opacity;
    const PaneModel* panes;
    std::uint32_t instance;  // or no_instance where the geometry is instanced
};

/// Lets a ray pass where its hash says that the surface is not there for it.
void pass_transparent(const RTCFilterFunctionNArguments* args);

/// The same for a pane and its strongest channel.
void pass_panes(const RTCFilterFunctionNArguments* args);

/// Lets a shadow ray pass a pane, or collects the colours of those that pass_panes lets pass.
void pass_light(const RTCFilterFunctionNArguments* args);

}  // namespace relumine
