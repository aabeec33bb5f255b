// SPDX-License-Identifier: Apache-2.0
// Rays of elements.
#include "radiance/field_trace.hpp"

#include "base/sample_packet_kernel.hpp"
#include "radiance/direct_light.hpp"
#include "radiance/lobe_walk.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

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
    return {.max_depth = std::min(settings.bounces, most) + 1, .sample_lights = settings.light_samples > 0};
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

/// The rays of an element, all at once.
struct ElementRays {
    std::vector<SampleStream> streams;
    std::vector<Ray> rays;
    std::vector<Hit> hits;

    [[nodiscard]] std::size_t size() const { return rays.size(); }
};

/// Streams and their numbers for the direction, by the part of the hemisphere that these stand for: rays of a
/// packet go together, and what follows finds triangles and cells in the processor's caches.
struct DirectedStreams {
    std::vector<SampleStream> streams;
    std::vector<Point2> numbers;

    explicit DirectedStreams(std::span<const SampleStream> drawn)
        : streams(drawn.size()), numbers(drawn.size()) {
        std::vector<Point2> u;
        for (const SampleStream& s : drawn) u.push_back(s.next2(Dim::direction));
        std::array<std::uint32_t, cells + 1> next{};
        for (const Point2 p : u) ++next[cell_of(p) + 1];
        for (std::size_t i = 1; i < next.size(); ++i) next[i] += next[i - 1];
        for (std::size_t i = 0; i < u.size(); ++i) {
            const std::uint32_t place = next[cell_of(u[i])]++;
            streams[place] = drawn[i];
            numbers[place] = u[i];
        }
    }

  private:
    static constexpr std::size_t cells = 16;
    /// Four by four, in Morton order.
    static std::size_t cell_of(Point2 p) {
        constexpr std::array<std::uint8_t, 4> spread{0, 1, 4, 5};
        const auto quarter = [](float x) { return static_cast<std::size_t>(std::min(4 * x, 3.0f)); };
        return static_cast<std::size_t>(spread[quarter(p.x)] | spread[quarter(p.y)] << 1);
    }
};

void trace(const Transport& t, ElementRays& all, RayCounts& counts) {
    counts.add(RayPurpose::field, all.size());
    all.hits.resize(all.size());
    for (std::size_t first = 0; first < all.size(); first += packet_size) {
        const std::size_t count = std::min(packet_size, all.size() - first);
        RayLanes rays;
        HitLanes hits;
        rays.t_max.fill(-1);
        for (std::size_t i = 0; i < count; ++i) rays.set(i, all.rays[first + i]);
        t.tracer.closest_hits(rays, hits, Coherence::incoherent);
        for (std::size_t i = 0; i < count; ++i)
            all.hits[first + i] = hits.instance[i] == no_instance ? Hit{} : hits[i];
    }
}

/// Draws and traces `count` rays over the hemispheres of the points.
ElementRays trace_rays(const Transport& t, std::span<const StartPoint> points, ElementId id, int count,
                       std::uint64_t seed, RayCounts& counts) {
    std::vector<SampleStream> drawn;
    for (int i = 0; i < count; ++i)
        drawn.push_back(element_stream(seed, id, static_cast<std::uint32_t>(i), count));
    DirectedStreams directed(drawn);
    ElementRays all;
    all.rays.reserve(drawn.size());
    for (std::size_t i = 0; i < drawn.size(); ++i) {
        const SampleStream& stream = directed.streams[i];
        const StartPoint& p = points[point_of(points, static_cast<int>(stream.index), count)];
        const WorldDir direction = frame_around(p.normal).to_world(cosine_hemisphere(directed.numbers[i]));
        all.rays.push_back({p.position + p.normal * p.offset, direction, infinity,
                            t.tracer.asks_for_opacity() ? stream.bits(Dim::opacity, 2) : 0u});
    }
    all.streams = std::move(directed.streams);
    trace(t, all, counts);
    return all;
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
        walk_lobes(t_, paths, lobe_walk(settings_), all.streams, found, counts,
                   [&](std::size_t i, const DiffuseVertex& at) {
                       const SurfacePoint& p = at.vertex.point;
                       view_.landings.push_back({p.position, p.geometric_normal, p.offset, all.hits[i].t,
                                                 at.weight, direction(all, i),
                                                 static_cast<std::uint16_t>(all.streams[i].index)});
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
        add_arriving(view_.light, normal_, from, found * share());
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

Ray shadow_ray(const StartPoint& start, const LightSample& light, std::uint32_t opacity_seed) {
    SurfacePoint p;
    p.position = start.position;
    p.geometric_normal = start.normal;
    p.offset = start.offset;
    return relumine::shadow_ray(p, light, opacity_seed);
}

LightSample light_in(const LightLanes& lights, std::size_t lane) {
    return {{lights.w_in[lane]},   lights.target[lane], lights.distance[lane],
            lights.radiance[lane], lights.pdf[lane],    lights.delta[lane] != 0};
}

/// Light samples at an element's points.
class LightSurvey {
  public:
    LightSurvey(const Transport& t, Vec3 normal, std::span<const StartPoint> points, ElementId id,
                const FieldSettings& settings, RayCounts& rays)
        : t_(t),
          normal_(normal),
          points_(points),
          id_(id),
          settings_(settings),
          counts_(rays),
          contrast_(points.size()) {}

    void run(ElementSurvey& survey) {
        for (int first = 0; first < settings_.light_samples; first += static_cast<int>(packet_size))
            sample(first);
        survey.light = light_;
        survey.contrast = contrast_.over_noise() * static_cast<float>(settings_.light_samples);
    }

  private:
    /// Sixteen samples, from `first` on.
    void sample(int first) {
        const int count = settings_.light_samples;
        const std::uint64_t seed = hash(settings_.seed, 0x6c6967687473);
        StreamPacket streams;
        std::array<std::size_t, packet_size> points;
        Vec3Lanes from;
        LaneMask all;
        all.fill(-1);
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            const int i = first + static_cast<int>(lane);
            streams[lane] = element_stream(seed, id_, static_cast<std::uint32_t>(i), count);
            points[lane] = point_of(points_, i, count);
            from.set(lane, points_[points[lane]].position);
        }
        Lanes<float> x, y;
        SamplePacket(streams).next2(Dim::light_point, 0, x, y);
        LightLanes lights{};
        t_.lights.sample(from, x, y, all, lights);
        propose(points, streams, lights);
    }

    /// Traces rays to those of the lights that may shine on their points.
    void propose(const std::array<std::size_t, packet_size>& points, const StreamPacket& streams,
                 const LightLanes& lights) {
        RayLanes rays;
        rays.t_max.fill(-1);
        std::array<Proposal, packet_size> proposals;
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < packet_size; ++lane) {
            const std::size_t point = points[lane];
            const float cosine = dot(lights.w_in[lane], points_[point].normal);
            if (lights.drawn[lane] == 0 || !(lights.pdf[lane] > 0) || !(cosine > 0)) {
                contrast_.add(point, 0);
                continue;
            }
            rays.set(count,
                     shadow_ray(points_[point], light_in(lights, lane), streams[lane].bits(Dim::opacity, 1)));
            proposals[count++] = {lane, point, cosine};
        }
        counts_.add(RayPurpose::shadow, count);
        SpectrumLanes passed;
        passed_light(t_.tracer, rays, count, passed);
        for (std::size_t i = 0; i < count; ++i) add(proposals[i], lights, passed[i]);
    }

    struct Proposal {
        std::size_t lane, point;
        float cosine;
    };

    /// Adds a sample's share of the irradiance.
    void add(const Proposal& p, const LightLanes& lights, Spectrum passed) {
        const float here = static_cast<float>(settings_.light_samples) * lights.pdf[p.lane];
        const float density =
            lights.delta[p.lane] != 0 ? here : here + static_cast<float>(settings_.rays) * inv_pi * p.cosine;
        const Spectrum irradiance = passed * lights.radiance[p.lane] * (p.cosine / density);
        contrast_.add(p.point, luminance(irradiance));
        if (!is_black(irradiance))
            add_arriving(light_, normal_, turned(lights.w_in[p.lane], points_[p.point].normal, normal_),
                         irradiance);
    }

    const Transport& t_;
    const Vec3 normal_;
    std::span<const StartPoint> points_;
    ElementId id_;
    const FieldSettings& settings_;
    RayCounts& counts_;
    Contrast contrast_;
    IrradianceVector light_;
};

/// The geometric mean of distances to what is seen.
float middle_distance(std::span<const Hit> hits) {
    float sum = 0, count = 0;
    for (const Hit& hit : hits) {
        if (!hit) continue;
        sum += std::log(std::max(hit.t, least_distance));
        count += 1;
    }
    return count > 0 ? std::exp(sum / count) : infinity;
}

}  // namespace

SampleStream element_stream(std::uint64_t seed, ElementId element, std::uint32_t ray, int rays) {
    return {hash(seed, element, 0x656c656d656e74), ray, static_cast<std::uint32_t>(rays), PointSet::sobol};
}

void add_arriving(IrradianceVector& vector, Vec3 normal, Vec3 direction, Spectrum irradiance) {
    const float cosine = dot(direction, normal);
    const Vec3 along = direction - normal * cosine;
    vector.add(normal + along / std::max(cosine, least_tilt_cosine), irradiance);
}

ElementSurvey survey_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                             ElementId id, const FieldSettings& settings, RayCounts& rays) {
    ElementSurvey survey;
    if (!t.lights.empty()) LightSurvey(t, normal, points, id, settings, rays).run(survey);
    const std::uint64_t seed = hash(settings.seed, 0x64697374);
    survey.distance =
        middle_distance(trace_rays(t, points, id, static_cast<int>(packet_size), seed, rays).hits);
    return survey;
}

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
                       land(i, at);
                       return true;
                   });
    }

    /// A ray of either kind brings L · cos θ / (n p_cos + m p_guide); landings count it in units of L · π /
    /// n.
    void land(std::size_t i, const DiffuseVertex& at) {
        const Ray& ray = rays_.rays[i];
        const auto drawn = static_cast<int>(rays_.streams[i].index);
        const std::size_t p = point_of(points_, drawn, settings_.guided_rays);
        const SurfacePoint& s = at.vertex.point;
        view_.landings.push_back({s.position, s.geometric_normal, s.offset, rays_.hits[i].t,
                                  at.weight * share(p, ray.direction),
                                  turned(ray.direction.v, points_[p].normal, normal_),
                                  static_cast<std::uint16_t>(settings_.rays + drawn)});
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
