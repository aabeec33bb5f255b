// SPDX-License-Identifier: Apache-2.0
// Point radiosity: irradiance on all surfaces that gather rays and their reflections meet, smooth and free of
// noise, for any soup of triangles.
//
// Surfaces are covered by elements, one for each side of what a cubic cell holds of them. An element traces
// rays once and keeps the elements that they meet as links, with the exact albedo there; iterations over the
// links then give all bounces without rays. In the spirit of the point-based methods of
// [Christensen08]; cells, links and interpolation are our own.
#pragma once

#include <functional>
#include <optional>
#include <span>

#include "radiance/bright_cones.hpp"
#include "radiance/field_arrivals.hpp"
#include "radiance/field_neighbors.hpp"
#include "radiance/path_guide.hpp"

namespace relumine {

/// A place whose gather rays the field must know about.
struct FieldSeed {
    Vec3 position, normal;  // unit
    float offset = 0;       // metres along the normal that clear rounding errors
};

struct FieldSettings {
    float cell = 0.05f;  // the cells' size over the median distance that rays from seeds travel
    int finest = 2;      // octaves by which cells shrink where surfaces are near each other
    float divide_above =
        0.15f;                // cells shrink where their size exceeds this share of how far what they see is
    float edge_above = 0.2f;  // and where light that comes straight from lights differs by more of its mean
    int rays = 128;           // that each element traces over its hemisphere; a multiple of 16
    int guided_rays = 32;     // to bright elements, besides; likewise
    int light_samples = 64;   // likewise
    std::size_t most_elements = 300'000;
    std::uint32_t bounces =
        0xffffffffu;        // of light, after the one that elements receive straight from lights
    bool arrivals = false;  // whether elements keep where their light comes from
    std::uint64_t seed = 0;
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon. May be empty
};

/// What building took.
struct FieldFigures {
    std::size_t elements = 0, links = 0;
    std::size_t bytes = 0;  // while it is used
    std::size_t iterations = 0;
    double unresolved = 0;  // share of the links that led nowhere
};

struct BuiltField;

class RadianceField {
  public:
    /// A function of scene, seeds and settings alone, whatever the number of threads.
    RadianceField(const Transport& t, std::span<const FieldSeed> seeds, const FieldSettings& settings,
                  RayCounts& rays);

    /// Irradiance on a surface with these normals, all bounces and lights included, W·m⁻²; empty where the
    /// field knows nothing.
    [[nodiscard]] std::optional<Spectrum> irradiance(Vec3 position, Vec3 geometric_normal,
                                                     Vec3 shading_normal) const;

    /// Whether a surface point is one of those that `bright_cones()` is made for.
    [[nodiscard]] bool is_bright(Vec3 position, Vec3 geometric_normal) const;
    [[nodiscard]] const BrightCones& bright_cones() const { return cones_; }
    /// Where light at a surface point comes from, as far as the field knows and its settings wanted to.
    [[nodiscard]] PlacedArrivals arrivals(Vec3 position, Vec3 geometric_normal) const;
    /// Of all that is reflected, over the elements' area; luminance, W·sr⁻¹·m⁻².
    [[nodiscard]] float mean_radiance() const { return mean_radiance_; }
    /// Of irradiance(), what is left of it after so many reflections more than the first gather rays have
    /// behind them, in the mean: where the number of reflections is limited.
    [[nodiscard]] float share_after(std::uint32_t reflections) const {
        return reflections == 0 || shares_.empty()
                   ? 1
                   : shares_[std::min<std::size_t>(reflections, shares_.size()) - 1];
    }
    /// What a ray finds along lobes counts for no more than this; luminance, W·sr⁻¹·m⁻².
    [[nodiscard]] float most_found() const { return most_found_; }

    [[nodiscard]] const FieldFigures& figures() const { return figures_; }
    [[nodiscard]] const FieldCells& cells() const { return cells_; }

  private:
    RadianceField(const Transport& t, BuiltField built, int threads, RayCounts& rays);

    FieldFigures figures_;
    BrightCones cones_;
    std::vector<ElementArrivals> arrivals_;  // by element
    std::vector<float> shares_;              // after one, two, … reflections; empty: always 1
    float mean_radiance_ = 0;
    float most_found_ = 0;
    FieldCells cells_;
    FieldNeighbors neighbors_;
};

}  // namespace relumine
