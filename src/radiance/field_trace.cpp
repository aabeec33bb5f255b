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

/// Lobes take part in what is left of the bounces.
LobeWalk lobe_walk(const FieldSettings& settings) {
    constexpr std::uint32_t most = unlimited_depth - 1;
    return {.max_depth = std::min(settings.bounces, most) + 1};
}

/// How far the means of samples differ between an element's points, beyond what samples at one point do.
class Contrast {
  public:
    explicit Contrast(std::size_t points) : points_(points) {}
    void add(std::size_t point, float x) {
        points_[point].count += 1;
        points_[point].sum += x;
        points_[point].squares += sqr(x);
    }

    /// The standard deviation between points, what noise accounts for taken away; 0 where that is all.
    [[nodiscard]] float over_noise() const {
        float means = 0, squares = 0, noise = 0, count = 0;
        for (const Point& p : points_) {
            if (p.count < 2) continue;
            const float mean = p.sum / p.count;
            means += mean;
            squares += sqr(mean);
            noise += std::max(0.0f, p.squares / p.count - sqr(mean)) / (p.count - 1);
            count += 1;
        }
        if (count < 2) return 0;
        const float between = squares / count - sqr(means / count);
        return std::sqrt(std::max(0.0f, between - noise / count));
    }

  private:
    struct Point {
        float count = 0, sum = 0, squares = 0;
    };
    std::vector<Point> points_;
};

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
        Spectrum emission = path.throughput * first_emission(t_, path), found;
        if (!is_black(emission)) emission *= share_of_light(start, path);
        if (hit) {
            log_distances_ += std::log(std::max(hit.t, least_distance));
            ++seen_;
            walk_lobes(t_, path, lobe_walk(settings_), stream, found, counts_, [&](const DiffuseVertex& at) {
                const SurfacePoint& p = at.vertex.point;
                view_.landings.push_back({p.position, p.geometric_normal, p.offset, hit.t, at.weight,
                                          direction, static_cast<std::uint16_t>(stream.index)});
                return true;
            });
        }
        if (!is_finite(emission + found)) return;
        const float share = pi / static_cast<float>(settings_.rays);
        add_arriving(view_.light, normal_, direction, (emission + found) * share);
        if (settings_.arrivals && !hit && !is_black(emission))
            view_.sky.push_back({direction, luminance(emission) * share});
        if (luminance(found) > 0) view_.finds.push_back(luminance(found));
        if (luminance(found) > strongest_) {
            strongest_ = luminance(found);
            view_.strongest = {};
            add_arriving(view_.strongest, normal_, direction, found * share);
        }
    }

    /// The balance heuristic against light samples.
    [[nodiscard]] float share_of_light(const StartPoint& start, const PathState& path) const {
        const float here =
            static_cast<float>(settings_.rays) * inv_pi * dot(path.ray.direction.v, start.normal);
        return here / (here + static_cast<float>(settings_.light_samples) * light_density(t_, path));
    }

    void sample_lights() {
        if (t_.lights.empty()) return;
        Contrast contrast(points_.size());
        for (int i = 0; i < settings_.light_samples; ++i) {
            const SampleStream stream =
                element_stream(hash(settings_.seed, 0x6c6967687473), id_, static_cast<std::uint32_t>(i),
                               settings_.light_samples);
            const std::size_t point = point_of(points_, i, settings_.light_samples);
            contrast.add(point, luminance(sample_light(points_[point], stream)));
        }
        view_.contrast = contrast.over_noise() * static_cast<float>(settings_.light_samples);
    }

    /// Adds a sample's share of the irradiance, and returns it.
    Spectrum sample_light(const StartPoint& start, const SampleStream& stream) {
        const auto light = t_.lights.sample(start.position, stream.next2(Dim::light_point));
        if (!light || !(light->pdf > 0)) return {};
        const float cosine = dot(light->w_in.v, start.normal);
        if (cosine <= 0) return {};
        SurfacePoint p;
        p.position = start.position;
        p.geometric_normal = start.normal;
        p.offset = start.offset;
        const Spectrum passed = passed_light(t_, p, *light, stream.bits(Dim::opacity, 1), counts_);
        if (is_black(passed)) return {};
        const float here = static_cast<float>(settings_.light_samples) * light->pdf;
        const float density =
            light->delta ? here : here + static_cast<float>(settings_.rays) * inv_pi * cosine;
        const Spectrum irradiance = passed * light->radiance * (cosine / density);
        add_arriving(view_.light, normal_, turned(light->w_in.v, start.normal, normal_), irradiance);
        return irradiance;
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    ElementId id_;
    const FieldSettings& settings_;
    RayCounts& counts_;
    ElementView view_;
    float strongest_ = 0;  // radiance of view_.strongest
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
        walk_lobes(
            t_, path, lobe_walk(settings_), stream_of(i), found, counts_, [&](const DiffuseVertex& at) {
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
