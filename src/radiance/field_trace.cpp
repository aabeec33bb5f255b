// SPDX-License-Identifier: Apache-2.0
// Rays of elements.
#include "radiance/field_trace.hpp"

#include "radiance/direct_light.hpp"
#include "radiance/lobe_walk.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

/// A light's direction turns the irradiance vector no farther than from this cosine.
constexpr float least_tilt_cosine = 0.2f;

/// Nearest distance that counts, metres: a bound for the logarithm.
constexpr float least_distance = 1e-6f;

/// Height over the surface of rays that explore it, of the cell's size.
constexpr float lift = 0.05f;

/// Where straight down from `above` (not farther than `depth`) the element's surface lies.
std::optional<SurfacePoint> project(const Transport& t, const FieldElement& e, Vec3 above, float depth,
                                    RayCounts& rays) {
    constexpr float least_cosine = 0.9f;
    rays.add(RayPurpose::field);
    const Ray down{above, {-e.normal}, depth, 0};
    const Hit hit = t.tracer.closest_hit(down);
    if (!hit) return {};
    SurfacePoint p = surface_point(t.scene, hit, {e.normal});
    if (dot(p.geometric_normal, e.normal) < least_cosine) return {};
    return p;
}

bool sees(const Transport& t, Vec3 from, Vec3 to, RayCounts& rays) {
    const Vec3 way = to - from;
    const float distance = length(way);
    if (!(distance > 0)) return true;
    rays.add(RayPurpose::field);
    return !t.tracer.occluded({from, {way / distance}, distance, 0});
}

/// The point of the element's surface that lies below or above `target` along its normal, if it is in the
/// cell and can be seen from the element.
std::optional<SurfacePoint> surface_near(const Transport& t, const FieldCells& cells, const FieldElement& e,
                                         Vec3 target, RayCounts& rays) {
    const Vec3 up = e.normal * (lift * e.size + e.offset);
    const Vec3 across = target - e.position - e.normal * dot(target - e.position, e.normal);
    if (!sees(t, e.position + up, e.position + across + up, rays)) return {};
    auto p = project(t, e, e.position + across + up, 4 * lift * e.size + 2 * e.offset, rays);
    if (!p || !cells.in_cell_of(e, p->position)) return {};
    return p;
}

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

/// Runs of a Sobol sequence are well spread: each point has one.
std::size_t point_of(std::span<const StartPoint> points, int i, int count) {
    return static_cast<std::size_t>(i) * points.size() / static_cast<std::size_t>(count);
}

WorldDir cosine_direction(Vec3 normal, const SampleStream& stream) {
    return frame_around(normal).to_world(cosine_hemisphere(stream.next2(Dim::direction)));
}

/// A direction in the frame of `normal` as it was in that of `from`: what it makes with the normal stays.
Vec3 turned(Vec3 direction, Vec3 from, Vec3 normal) {
    const float cosine = dot(direction, from);
    Vec3 along = direction - from * cosine;
    along = along - normal * dot(along, normal);
    const float sine = std::sqrt(std::max(0.0f, 1 - sqr(cosine))), length_along = length(along);
    return normal * cosine + (length_along > 1e-6f ? along * (sine / length_along) : Vec3{});
}

class ElementTracer {
  public:
    ElementTracer(const Transport& t, Vec3 normal, std::span<const StartPoint> points, ElementId id,
                  const FieldSettings& settings, RayCounts& rays)
        : t_(t), normal_(normal), points_(points), id_(id), settings_(settings), counts_(rays) {}

    ElementView run() {
        for (int first = 0; first < settings_.rays; first += static_cast<int>(packet_size)) trace(first);
        if (seen_ > 0) view_.distance = std::exp(log_distances_ / static_cast<float>(seen_));
        sample_lights();
        return std::move(view_);
    }

  private:
    void trace(int first) {
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        std::array<const StartPoint*, packet_size> starts;
        StreamPacket streams;
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            const int i = first + static_cast<int>(lane);
            const StartPoint& p = points_[point_of(points_, i, settings_.rays)];
            streams[lane] =
                element_stream(settings_.seed, id_, static_cast<std::uint32_t>(i), settings_.rays);
            const WorldDir direction = cosine_direction(p.normal, streams[lane]);
            rays[lane] = {p.position + p.normal * p.offset, direction, infinity,
                          streams[lane].bits(Dim::opacity, 2)};
            starts[lane] = &p;
        }
        counts_.add(RayPurpose::field, packet_size);
        t_.tracer.closest_hits(rays, hits, Coherence::incoherent);
        for (std::size_t lane = 0; lane < packet_size; ++lane)
            follow(*starts[lane], rays[lane], hits[lane], streams[lane]);
    }

    void follow(const StartPoint& start, const Ray& ray, const Hit& hit, const SampleStream& stream) {
        PathState path{ray, hit, 1, 1, Spectrum{1}, 1, 0, false, static_cast<bool>(hit)};
        tint(t_, path);
        const Vec3 direction = turned(ray.direction.v, start.normal, normal_);
        Spectrum found = path.throughput * first_emission(t_, path);
        if (!is_black(found)) found *= share_of_light(start, path);
        if (hit) {
            log_distances_ += std::log(std::max(hit.t, least_distance));
            ++seen_;
            walk_lobes(t_, path, {}, stream, found, counts_, [&](const DiffuseVertex& at) {
                const SurfacePoint& p = at.vertex.point;
                view_.landings.push_back({p.position, p.geometric_normal, p.offset, hit.t, at.weight,
                                          direction, static_cast<std::uint16_t>(stream.index)});
                return true;
            });
        }
        if (is_finite(found))
            add_arriving(view_.light, normal_, direction, found * (pi / static_cast<float>(settings_.rays)));
    }

    /// The balance heuristic against light samples.
    [[nodiscard]] float share_of_light(const StartPoint& start, const PathState& path) const {
        const float here =
            static_cast<float>(settings_.rays) * inv_pi * dot(path.ray.direction.v, start.normal);
        return here / (here + static_cast<float>(settings_.light_samples) * light_density(t_, path));
    }

    void sample_lights() {
        if (t_.lights.empty()) return;
        for (int i = 0; i < settings_.light_samples; ++i) {
            const SampleStream stream =
                element_stream(hash(settings_.seed, 0x6c6967687473), id_, static_cast<std::uint32_t>(i),
                               settings_.light_samples);
            sample_light(points_[point_of(points_, i, settings_.light_samples)], stream);
        }
    }

    void sample_light(const StartPoint& start, const SampleStream& stream) {
        const auto light = t_.lights.sample(start.position, stream.next2(Dim::light_point));
        if (!light || !(light->pdf > 0)) return;
        const float cosine = dot(light->w_in.v, start.normal);
        if (cosine <= 0) return;
        SurfacePoint p;
        p.position = start.position;
        p.geometric_normal = start.normal;
        p.offset = start.offset;
        const Spectrum passed = passed_light(t_, p, *light, stream.bits(Dim::opacity, 1), counts_);
        if (is_black(passed)) return;
        const float here = static_cast<float>(settings_.light_samples) * light->pdf;
        const float density =
            light->delta ? here : here + static_cast<float>(settings_.rays) * inv_pi * cosine;
        add_arriving(view_.light, normal_, turned(light->w_in.v, start.normal, normal_),
                     passed * light->radiance * (cosine / density));
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    ElementId id_;
    const FieldSettings& settings_;
    RayCounts& counts_;
    ElementView view_;
    float log_distances_ = 0;
    int seen_ = 0;
};

}  // namespace

SampleStream element_stream(std::uint64_t seed, ElementId element, std::uint32_t ray, int rays) {
    return {hash(seed, element, 0x656c656d656e74), ray, static_cast<std::uint32_t>(rays), PointSet::sobol};
}

void add_arriving(IrradianceVector& vector, Vec3 normal, Vec3 direction, Spectrum irradiance) {
    const float cosine = dot(direction, normal);
    const Vec3 along = direction - normal * cosine;
    vector.add(normal + along / std::max(cosine, least_tilt_cosine), irradiance);
}

void center(const Transport& t, const FieldCells& cells, FieldElement& e, RayCounts& rays) {
    const Vec3 middle = cells.middle_of(e);
    for (const float part : {1.0f, 0.6f, 0.3f}) {
        const auto p = surface_near(t, cells, e, lerp(e.position, middle, part), rays);
        if (!p) continue;
        e.position = p->position;
        e.offset = p->offset;
        return;
    }
}

std::vector<StartPoint> start_points(const Transport& t, const FieldCells& cells, ElementId id,
                                     std::uint64_t seed, RayCounts& rays) {
    const std::uint32_t tries = cells.elements()[id].coarse ? 32 : 16;
    constexpr float reach = 1.42f;  // of a square that contains the cell's section with any plane
    const FieldElement& e = cells.elements()[id];
    const Frame frame = frame_around(e.normal);
    const Vec3 middle = cells.middle_of(e);
    std::vector<StartPoint> points;
    for (std::uint32_t i = 0; i < tries; ++i) {
        const Point2 u =
            SampleStream{hash(seed, id, 0x706f696e7473), i, tries, PointSet::sobol}.next2(Dim::pixel);
        const Vec3 target = middle + (frame.s * (u.x - 0.5f) + frame.t * (u.y - 0.5f)) * (reach * e.size);
        if (const auto p = surface_near(t, cells, e, target, rays))
            points.push_back({p->position, p->geometric_normal, p->offset});
    }
    if (points.empty()) points.push_back({e.position, e.normal, e.offset});
    return points;
}

ElementView trace_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points, ElementId id,
                          const FieldSettings& settings, RayCounts& rays) {
    return ElementTracer(t, normal, points, id, settings, rays).run();
}

namespace {

class Guide {
  public:
    Guide(const Transport& t, Vec3 normal, std::span<const StartPoint> points, const BrightCones& cones,
          ElementId id, const FieldSettings& settings, RayCounts& rays)
        : t_(t), normal_(normal), points_(points), id_(id), settings_(settings), counts_(rays) {
        for (const StartPoint& p : points) tables_.push_back(cones.seen_from(p.position, p.normal));
    }

    GuidedView run() {
        for (int i = 0; i < settings_.rays; ++i) {
            const std::size_t p = point_of(points_, i, settings_.rays);
            const SampleStream stream =
                element_stream(settings_.seed, id_, static_cast<std::uint32_t>(i), settings_.rays);
            view_.share.push_back(share(p, cosine_direction(points_[p].normal, stream)));
        }
        for (int first = 0; first < settings_.guided_rays; first += static_cast<int>(packet_size))
            trace(first);
        return std::move(view_);
    }

  private:
    /// What a ray that way counts for, over what it would alone, if drawn by its cosine.
    [[nodiscard]] float share(std::size_t point, WorldDir direction) const {
        const float here =
            static_cast<float>(settings_.rays) * inv_pi * dot(direction.v, points_[point].normal);
        const BrightCones::Table& table = tables_[point];
        return here / (here + static_cast<float>(settings_.guided_rays) * pdf(table, direction));
    }

    void trace(int first) {
        std::array<Ray, packet_size> rays;
        std::array<Hit, packet_size> hits;
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            rays[lane].t_max = -1;
            const int i = first + static_cast<int>(lane);
            const std::size_t p = point_of(points_, i, settings_.guided_rays);
            if (tables_[p].count == 0) continue;
            const SampleStream stream = stream_of(i);
            const WorldDir direction = sample(tables_[p], stream.next2(Dim::direction)).direction;
            if (!(dot(direction.v, points_[p].normal) > 0)) continue;
            counts_.add(RayPurpose::field);
            rays[lane] = {points_[p].position + points_[p].normal * points_[p].offset, direction, infinity,
                          stream.bits(Dim::opacity, 2)};
        }
        t_.tracer.closest_hits(rays, hits, Coherence::incoherent);
        for (std::size_t lane = 0; lane < packet_size; ++lane)
            if (hits[lane]) follow(first + static_cast<int>(lane), rays[lane], hits[lane]);
    }

    [[nodiscard]] SampleStream stream_of(int i) const {
        return element_stream(hash(settings_.seed, 0x6775696465), id_, static_cast<std::uint32_t>(i),
                              settings_.guided_rays);
    }

    void follow(int i, const Ray& ray, const Hit& hit) {
        const std::size_t p = point_of(points_, i, settings_.guided_rays);
        // A ray of either kind brings L · cos θ / (n p_cos + m p_guide); links count it in units of L · π /
        // n.
        const float weight = share(p, ray.direction);
        const Vec3 direction = turned(ray.direction.v, points_[p].normal, normal_);
        Spectrum found;  // the rays of trace_element bring that
        PathState path{ray, hit, 1, 1, Spectrum{1}, 1, 0, false, true};
        tint(t_, path);
        walk_lobes(t_, path, {}, stream_of(i), found, counts_, [&](const DiffuseVertex& at) {
            const SurfacePoint& s = at.vertex.point;
            view_.landings.push_back({s.position, s.geometric_normal, s.offset, hit.t, at.weight * weight,
                                      direction, static_cast<std::uint16_t>(settings_.rays + i)});
            return true;
        });
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    std::vector<BrightCones::Table> tables_;  // by point
    ElementId id_;
    const FieldSettings& settings_;
    RayCounts& counts_;
    GuidedView view_;
};

}  // namespace

GuidedView guide_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                         const BrightCones& cones, ElementId id, const FieldSettings& settings,
                         RayCounts& rays) {
    return Guide(t, normal, points, cones, id, settings, rays).run();
}

}  // namespace relumine
