// SPDX-License-Identifier: Apache-2.0
// Rays of elements.
#include "radiance/field_trace.hpp"

#include "radiance/lobe_walk.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

Spectrum first_emission(const Transport& t, const PathState& path) {
    if (!path.hit) return t.lights.environment_radiance(path.ray.direction);
    const Mesh& mesh = t.scene.meshes[index(t.scene.instances[path.hit.instance].mesh)];
    if (is_black(t.scene.materials[index(mesh.material)].emission)) return {};
    return emitted_radiance(t.scene, surface_point(t.scene, path.hit, -path.ray.direction));
}

float light_density(const Transport& t, const PathState& path) {
    if (!path.hit) return t.lights.environment_pdf(path.ray.direction);
    return t.lights.pdf(path.ray.origin, surface_point(t.scene, path.hit, -path.ray.direction));
}

WorldDir cosine_direction(Vec3 normal, const SampleStream& stream) {
    return frame_around(normal).to_world(cosine_hemisphere(stream.next2(Dim::direction)));
}

/// Lobes take part in what is left of the bounces.
LobeWalk lobe_walk(const FieldSettings& settings) {
    constexpr std::uint32_t most = unlimited_depth - 1;
    return {.max_depth = std::min(settings.bounces, most) + 1, .sample_lights = settings.light_samples > 0};
}

/// How these rays walk on.
std::vector<PathState> paths_of(const Transport& t, const ElementRays& all) {
    std::vector<PathState> paths;
    paths.reserve(all.size());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const bool alive{all.hits[i]};
        paths.push_back({all.rays[i], all.hits[i], 1, 1, Spectrum{1}, 1, 0, false, alive});
        tint(t, paths.back());
    }
    return paths;
}

/// Of a path of paths_of that has come to a diffuse surface.
std::uint8_t lobes_before(const PathState& path) { return static_cast<std::uint8_t>(path.depth - 1); }

class ElementTracer {
  public:
    ElementTracer(const Transport& t, Vec3 normal, std::span<const StartPoint> points, int count,
                  const FieldSettings& settings)
        : t_(t), normal_(normal), points_(points), count_(count), settings_(settings) {}

    ElementView run(const ElementRays& all, RayCounts& counts) {
        std::vector<PathState> paths = paths_of(t_, all);
        for (std::size_t i = 0; i < all.size(); ++i) add_emission(all, i, paths[i]);
        std::vector<Spectrum> found(all.size());
        view_.landings.reserve(all.size() + all.size() / 4);
        walk_lobes(
            t_, paths, lobe_walk(settings_), all.streams, found, counts,
            [&](std::size_t i, const DiffuseVertex& at) {
                const SurfacePoint& p = at.vertex.point;
                view_.landings.push_back({p.position, p.geometric_normal, p.offset, all.hits[i].t, at.weight,
                                          direction(all, i), static_cast<std::uint16_t>(all.streams[i].index),
                                          lobes_before(paths[i])});
                return true;
            });
        for (std::size_t i = 0; i < found.size(); ++i)
            if (!is_black(found[i]) && is_finite(found[i])) add_found(direction(all, i), found[i]);
        return std::move(view_);
    }

  private:
    [[nodiscard]] const StartPoint& start(const ElementRays& all, std::size_t i) const {
        return points_[point_of(points_, static_cast<int>(all.streams[i].index), count_)];
    }
    [[nodiscard]] Vec3 direction(const ElementRays& all, std::size_t i) const {
        return turned(all.rays[i].direction.v, start(all, i).normal, normal_);
    }
    [[nodiscard]] float share() const { return pi / static_cast<float>(count_); }

    void add_emission(const ElementRays& all, std::size_t i, const PathState& path) {
        const Spectrum emission = path.throughput * first_emission(t_, path);
        if (is_black(emission)) return;
        const Spectrum irradiance = emission * (share_of_light(start(all, i), path) * share());
        if (!is_finite(irradiance)) return;
        const Vec3 from = direction(all, i);
        add_arriving(view_.light, normal_, from, irradiance);
        if (settings_.arrivals && !path.hit) view_.sky.push_back({from, luminance(irradiance)});
    }

    void add_found(Vec3 from, Spectrum found) {
        add_arriving(view_.reflected, normal_, from, found * share());
        view_.finds.push_back(luminance(found));
        if (luminance(found) <= strongest_) return;
        strongest_ = luminance(found);
        view_.strongest = {};
        add_arriving(view_.strongest, normal_, from, found * share());
    }

    /// The balance heuristic against light samples.
    [[nodiscard]] float share_of_light(const StartPoint& start, const PathState& path) const {
        const float here =
            static_cast<float>(settings_.rays) * inv_pi * dot(path.ray.direction.v, start.normal);
        return here / (here + static_cast<float>(settings_.light_samples) * light_density(t_, path));
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    const int count_;  // of rays
    const FieldSettings& settings_;
    ElementView view_;
    float strongest_ = 0;  // radiance of view_.strongest
};

}  // namespace

ElementView trace_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points, ElementId id,
                          int count, const FieldSettings& settings, RayCounts& rays) {
    const ElementRays all = trace_rays(t, points, id, count, settings.seed, rays);
    return ElementTracer(t, normal, points, count, settings).run(all, rays);
}

namespace {

class Guide {
  public:
    Guide(const Transport& t, Vec3 normal, std::span<const StartPoint> points, const BrightCones& cones,
          ElementId id, int count, const FieldSettings& settings)
        : t_(t), normal_(normal), points_(points), id_(id), count_(count), settings_(settings) {
        for (const StartPoint& p : points) tables_.push_back(cones.seen_from(p.position, p.normal));
    }

    GuidedView run(RayCounts& counts) {
        for (int i = 0; i < count_; ++i) {
            const std::size_t p = point_of(points_, i, count_);
            const SampleStream stream =
                element_stream(settings_.seed, id_, static_cast<std::uint32_t>(i), count_);
            view_.share.push_back(share(p, cosine_direction(points_[p].normal, stream)));
        }
        draw(counts);
        follow(counts);
        return std::move(view_);
    }

  private:
    /// What a ray that way counts for, over what it would alone, if drawn by its cosine.
    [[nodiscard]] float share(std::size_t point, WorldDir direction) const {
        const float here = static_cast<float>(count_) * inv_pi * dot(direction.v, points_[point].normal);
        const BrightCones::Table& table = tables_[point];
        return here / (here + static_cast<float>(settings_.guided_rays) * pdf(table, direction));
    }

    void draw(RayCounts& counts) {
        for (int i = 0; i < settings_.guided_rays; ++i) {
            const std::size_t p = point_of(points_, i, settings_.guided_rays);
            if (tables_[p].count == 0) continue;
            const SampleStream stream = element_stream(hash(settings_.seed, 0x6775696465), id_,
                                                       static_cast<std::uint32_t>(i), settings_.guided_rays);
            const WorldDir direction = sample(tables_[p], stream.next2(Dim::direction)).direction;
            if (!(dot(direction.v, points_[p].normal) > 0)) continue;
            rays_.streams.push_back(stream);
            rays_.rays.push_back({points_[p].position + points_[p].normal * points_[p].offset, direction,
                                  infinity, stream.bits(Dim::opacity, 2)});
        }
        trace(t_, rays_, counts);
    }

    void follow(RayCounts& counts) {
        std::vector<PathState> paths = paths_of(t_, rays_);
        std::vector<Spectrum> found(paths.size());  // the rays of trace_element bring that
        walk_lobes(t_, paths, lobe_walk(settings_), rays_.streams, found, counts,
                   [&](std::size_t i, const DiffuseVertex& at) {
                       land(i, at, lobes_before(paths[i]));
                       return true;
                   });
    }

    /// A ray of either kind brings L · cos θ / (n p_cos + m p_guide); landings count it in units of L · π /
    /// n.
    void land(std::size_t i, const DiffuseVertex& at, std::uint8_t lobes) {
        const Ray& ray = rays_.rays[i];
        const auto drawn = static_cast<int>(rays_.streams[i].index);
        const std::size_t p = point_of(points_, drawn, settings_.guided_rays);
        const SurfacePoint& s = at.vertex.point;
        view_.landings.push_back({s.position, s.geometric_normal, s.offset, rays_.hits[i].t,
                                  at.weight * share(p, ray.direction),
                                  turned(ray.direction.v, points_[p].normal, normal_),
                                  static_cast<std::uint16_t>(settings_.rays + drawn), lobes});
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    std::vector<BrightCones::Table> tables_;  // by point
    ElementId id_;
    const int count_;  // of rays over all directions
    const FieldSettings& settings_;
    ElementRays rays_;
    GuidedView view_;
};

}  // namespace

GuidedView guide_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                         const BrightCones& cones, ElementId id, int count, const FieldSettings& settings,
                         RayCounts& rays) {
    return Guide(t, normal, points, cones, id, count, settings).run(rays);
}

}  // namespace relumine
