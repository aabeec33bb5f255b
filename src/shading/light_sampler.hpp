// SPDX-License-Identifier: Apache-2.0
// All lights of a scene as one: drawing a direction towards light, and the density with which that would have
// been drawn.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "base/lanes.hpp"
#include "shading/environment_light.hpp"
#include "shading/light_tree.hpp"
#include "shading/surface_point.hpp"

namespace relumine {

struct LightSample {
    WorldDir w_in;  // from the shading point
    Vec3 target;    // the point on the light; only where `distance` is finite
    float distance = infinity;
    Spectrum radiance;  // incident; for delta lights: irradiance on a surface that faces the light
    float pdf = 0;      // per steradian; for delta lights: probability
    bool delta = false;
};

/// LightSample for sixteen points.
struct LightLanes {
    Vec3Lanes w_in, target;
    Lanes<float> distance;
    SpectrumLanes radiance;
    Lanes<float> pdf;
    LaneMask delta, drawn;  // drawn: whether there is a sample

    void set(std::size_t lane, const LightSample& light);
};

/// Points on emissive triangles of even radiance, before their direction and density are known.
struct TrianglePointLanes {
    Vec3Lanes corner, edge1, edge2, normal;
    Lanes<float> density, offset, u_x, u_y;
    SpectrumLanes radiance;
    LaneMask double_sided, chosen;
};

/// Which part of the light is sampled, and how.
struct LightSelection {
    float threshold = 0;  // radiance (channels' mean) that light must exceed: the environment anywhere in a
                          // texel, emitters on average
    bool delta_lights = true;               // point, spot and directional lights are among the choices
    bool compensate_for_mis = true;         // lower the environment's density by its mean [Karlik19]
    std::size_t tree_from = 17;             // the fewest lights at places that make a tree
    float most_local_threshold = infinity;  // what local emitters must exceed, if less than `threshold`
};

/// Draws lights by power, or many by a tree that also looks at where they are, and points on them uniformly.
/// Immutable.
class LightSampler {
  public:
    LightSampler(const SceneData& scene, const LightSelection& selection);
    ~LightSampler();

    /// A direction towards light from `from`; empty where nothing can be sampled or the sample shines away
    /// from the point.
    [[nodiscard]] std::optional<LightSample> sample(Vec3 from, float u_choice, Point2 u) const;
    /// The same from two numbers: what choosing leaves of u.x serves again, so that the points on every light
    /// are as well spread as the numbers are.
    [[nodiscard]] std::optional<LightSample> sample(Vec3 from, Point2 u) const;

    /// The same for the points of `lanes`. Most lights are triangles, whose samples are computed side by
    /// side.
    void sample(const Vec3Lanes& from, const Lanes<float>& u_x, const Lanes<float>& u_y,
                const LaneMask& lanes, LightLanes& samples) const;

    /// Density with which `sample` at `from` would have drawn the emissive surface point `hit` (seen from
    /// `from`).
    [[nodiscard]] float pdf(Vec3 from, const SurfacePoint& hit) const;
    /// The same for the environment.
    [[nodiscard]] float environment_pdf(WorldDir direction) const;

    /// Radiance from infinity, 0 where there is no environment.
    [[nodiscard]] Spectrum environment_radiance(WorldDir direction) const;

    /// Whether there is anything to draw.
    [[nodiscard]] bool empty() const { return environment_probability_ <= 0 && local_probability_ <= 0; }

  private:
    struct EmissiveTriangle {
        Vec3 corner, edge1, edge2;  // world space
        Vec3 normal;                // unit, front
        float area;                 // metres²
        float density;  // of its points among all lights', 1/metres²; 0 where it has no area; with a
                        // tree, if this light were the only local one
        float offset;   // metres along the normal that clear rounding errors
        std::uint32_t instance, triangle;
        Spectrum radiance;  // where it is the same everywhere
        bool double_sided, varies;

        void put(TrianglePointLanes& points, std::size_t lane, float probability, Point2 u) const;
    };
    enum class Kind : std::uint8_t { triangle, point, spot, directional };
    struct LocalLight {
        Kind kind;
        std::uint32_t index;
    };

    void add_emissive_instance(std::uint32_t instance, const LightSelection& selection,
                               std::vector<double>& powers);
    void add_delta_lights(std::vector<double>& powers);
    void grow_tree(const std::vector<double>& powers);
    [[nodiscard]] LightBounds bounds_of(const LocalLight& light, double power) const;
    [[nodiscard]] std::optional<LightSample> sample_triangle(const EmissiveTriangle& light, float probability,
                                                             Vec3 from, Point2 u) const;
    [[nodiscard]] std::optional<LightSample> sample_environment(Point2 u) const;
    /// A light of local_ that was drawn.
    struct LocalChoice {
        std::size_t light;
        float probability;  // among local_ where there is a tree, else 1: the densities have it in them
        float u;            // what choosing has left
    };
    [[nodiscard]] std::size_t choose_by_power(float u) const;  // of local_
    /// Empty where none can shine on `from`.
    [[nodiscard]] std::optional<LocalChoice> choose_local(Vec3 from, float u) const;
    [[nodiscard]] const EmissiveTriangle* even_triangle(std::size_t chosen) const;  // or null
    [[nodiscard]] std::optional<LightSample> sample_local(const LocalChoice& chosen, Vec3 from,
                                                          Point2 u) const;
    [[nodiscard]] Spectrum emitted(const EmissiveTriangle& light, const Hit& hit) const;

    const SceneData& scene_;
    std::optional<EnvironmentLight> environment_;
    float environment_probability_ = 0, local_probability_ = 0;
    std::vector<EmissiveTriangle> triangles_;
    std::vector<std::uint32_t> first_triangle_;  // per instance; no_light where it has none
    std::vector<LocalLight> local_;
    std::vector<float> local_cdf_;   // local_.size() + 1
    std::optional<LightTree> tree_;  // over the first of local_, those at places
    std::size_t places_ = 0;         // how many these are
    float tree_probability_ = 0;     // of the tree against directional lights
};

/// LightSampler::sample of the chosen triangles; leaves other lanes of `samples` alone.
void sample_triangles(const TrianglePointLanes& points, const Vec3Lanes& from, LightLanes& samples);

/// The light of point, spot and directional lights, one sample each; for methods that loop over all of them.
[[nodiscard]] std::vector<LightSample> delta_light_samples(const SceneData& scene, Vec3 from);

/// The radiance over which light counts as bright: `factor` times the mean that the scene's light has over
/// the sphere.
[[nodiscard]] float bright_threshold(const SceneData& scene, float factor);

}  // namespace relumine
