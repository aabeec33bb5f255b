// SPDX-License-Identifier: Apache-2.0
// Where rays meet the scene: a thin layer over Embree 3 or 4.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "base/frame.hpp"
#include "base/lanes.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

struct Ray {
    Vec3 origin;
    WorldDir direction;
    float t_max = infinity;          // in units of the (unit) direction
    std::uint32_t opacity_seed = 0;  // decides which partly transparent surfaces this ray sees
};

inline constexpr std::uint32_t no_instance = 0xffffffffu;

struct Hit {
    float t = infinity;
    float u = 0, v = 0;  // barycentric weights of the triangle's second and third vertex
    std::uint32_t instance = no_instance;
    std::uint32_t triangle = 0;

    explicit operator bool() const { return instance != no_instance; }
};

/// Sixteen rays side by side.
struct RayLanes {
    Vec3Lanes origin, direction;
    Lanes<float> t_max;  // < 0: no ray
    Lanes<std::uint32_t> opacity_seed;

    [[nodiscard]] Ray operator[](std::size_t i) const {
        return {origin[i], {direction[i]}, t_max[i], opacity_seed[i]};
    }
    void set(std::size_t i, const Ray& ray) {
        origin.set(i, ray.origin);
        direction.set(i, ray.direction.v);
        t_max[i] = ray.t_max;
        opacity_seed[i] = ray.opacity_seed;
    }
    void take(std::size_t i, const RayLanes& other, std::size_t j) { set(i, other[j]); }
};

/// What they have hit.
struct HitLanes {
    Lanes<float> t, u, v;
    Lanes<std::uint32_t> instance, triangle;

    [[nodiscard]] Hit operator[](std::size_t i) const { return {t[i], u[i], v[i], instance[i], triangle[i]}; }
    void set(std::size_t i, const Hit& hit) {
        t[i] = hit.t;
        u[i] = hit.u;
        v[i] = hit.v;
        instance[i] = hit.instance;
        triangle[i] = hit.triangle;
    }
    void take(std::size_t i, const HitLanes& other, std::size_t j) { set(i, other[j]); }
};

/// Whether the rays of a packet start and point nearly alike, as camera rays do: a hint for speed.
enum class Coherence { coherent, incoherent };

/// The opacity in [0, 1] of a point on a triangle (fields t unset).
using OpacityFunction = std::function<float(const Hit&)>;

/// A surface that lets light pass straight without being a vertex of its path: thin, smooth glass.
enum class Pane { none, grey, coloured };

/// Which meshes are panes, and what share of light passes them at a hit (field t unset) along a direction.
struct PaneModel {
    std::function<Pane(const Mesh&)> kind;
    std::function<Spectrum(const Hit&, WorldDir)> transmittance;
};

/// The acceleration structure over a scene. Immutable; any number of threads may trace at a time, with
/// denormals flushed.
///
/// Surfaces that are not opaque are met with a probability of their opacity, decided by a hash of the ray's
/// opacity_seed and the triangle, so that neither the order of traversal nor the thread can change the
/// answer. Panes are met likewise, with a probability of what they do not let pass of their strongest
/// channel; shadow rays pass them all and lose what each takes.
class Tracer {
  public:
    /// Builds over `scene`, which must outlive the tracer. `opacity` is asked for materials whose alpha mode
    /// is not opaque, `panes` for all; without it there are none.
    Tracer(const SceneData& scene, OpacityFunction opacity, PaneModel panes = {});
    ~Tracer();
    Tracer(const Tracer&) = delete;
    Tracer& operator=(const Tracer&) = delete;

    /// What builds the tree and meets it, with its version: other ones may decide otherwise between equal
    /// hits.
    [[nodiscard]] static std::string library();

    /// Whether there is anything that is not opaque: if not, Ray::opacity_seed does not matter.
    [[nodiscard]] bool asks_for_opacity() const { return asks_for_opacity_; }
    /// If not, passed_light() is 1 where `occluded` is false.
    [[nodiscard]] bool has_panes() const { return has_panes_; }
    /// If not, tint() is 1.
    [[nodiscard]] bool has_coloured_panes() const { return has_coloured_panes_; }

    [[nodiscard]] Hit closest_hit(const Ray& ray) const;
    /// Whether anything but panes is in the way.
    [[nodiscard]] bool occluded(const Ray& ray) const;
    /// The share of light that comes along the ray from its end: 0 where it is blocked, else the product of
    /// the panes' transmittances.
    [[nodiscard]] Spectrum passed_light(const Ray& ray) const;
    /// What the panes that closest_hit(ray) has passed up to `t` do to colours: their transmittances over
    /// those of their strongest channels.
    [[nodiscard]] Spectrum tint(const Ray& ray, float t) const;

    /// Sixteen rays at once. Rays with t_max < 0 are left out. A lane's last digits may depend on its
    /// neighbours, so a packet must always be traced with the same sixteen rays. Lanes that are left out have
    /// no hit and are not occluded.
    void closest_hits(std::span<const Ray, packet_size> rays, std::span<Hit, packet_size> hits,
                      Coherence coherence) const;
    void occluded(std::span<const Ray, packet_size> rays, std::span<bool, packet_size> blocked) const;
    void passed_light(std::span<const Ray, packet_size> rays, std::span<Spectrum, packet_size> share) const;
    /// The same of lanes. Where there is no hit, `instance` alone says so.
    void closest_hits(const RayLanes& rays, HitLanes& hits, Coherence coherence) const;
    void occluded(const RayLanes& rays, LaneMask& blocked) const;
    void passed_light(const RayLanes& rays, SpectrumLanes& share) const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
    bool asks_for_opacity_ = false, has_panes_ = false, has_coloured_panes_ = false;
};

}  // namespace relumine
