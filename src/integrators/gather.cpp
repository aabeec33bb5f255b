// SPDX-License-Identifier: Apache-2.0
// The Monte Carlo gather: prefix, direct light of lights without extent, gather rays in packets.
#include "integrators/gather.hpp"

#include "integrators/path_tracer.hpp"
#include "radiance/direct_light.hpp"
#include "shading/material.hpp"

namespace relumine {
namespace {

/// Light whose radiance exceeds this many times the environment's mean is also sampled directly, if light
/// samples are asked for.
constexpr float bright_factor = 4;

/// Mirrors and glass that a prefix may meet: one that meets more is caught between lossless surfaces.
constexpr std::uint32_t longest_prefix = 1024;

/// How many scattering vertices behind the gather ray's hit the radiance source adds.
std::uint32_t source_depth(const std::string& radiance) {
    if (radiance == "emission") return 0;
    if (radiance == "direct") return 1;
    return unlimited_depth;
}

std::uint32_t saturating_add(std::uint32_t a, std::uint32_t b) {
    return a > unlimited_depth - b ? unlimited_depth : a + b;
}

/// Where a surface seen through mirrors and glass begins to scatter, with what came before it.
struct ShadingPoint {
    PathState path;  // throughput up to here
    Vertex vertex;   // its BSDF without delta lobes
};

/// One gather ray: the BSDF sample behind it and its own random numbers.
struct GatherRay {
    SampleStream stream;
    Spectrum weight;  // f·|cos θ| / pdf
    float pdf = 0;
};

class Gather final : public Integrator {
  public:
    Gather(const RenderSettings& settings, const Transport& transport, const View& view, bool surface_layers)
        : transport_(transport),
          view_(view),
          surface_layers_(surface_layers),
          rays_(static_cast<std::uint32_t>(settings.gather_rays)),
          light_samples_(static_cast<std::uint32_t>(settings.light_samples)),
          max_depth_(depth_limit(settings)),
          source_depth_(source_depth(settings.radiance)),
          coherence_(view.point_set == PointSet::stratified ? Coherence::coherent : Coherence::incoherent) {
        const LightSelection bright{bright_threshold(transport.scene, bright_factor), false, false};
        if (light_samples_ > 0) bright_lights_ = std::make_unique<LightSampler>(transport.scene, bright);
    }

    void render(Tile& tile) const override {
        for_each_camera_packet(view_, transport_.tracer, tile, [&](const CameraPacket& samples) {
            for (const CameraSample& s : samples) {
                if (!tile.contains(s.x, s.y)) continue;
                const SplitRadiance radiance = outgoing_radiance(s, tile.rays);
                tile.add(s.x, s.y, s.stream.index, radiance,
                         surface_layers_ ? first_surface(transport_, s) : FirstSurface{});
            }
        });
    }

  private:
    SplitRadiance outgoing_radiance(const CameraSample& s, RayCounts& rays) const {
        SplitRadiance sum;
        const std::optional<ShadingPoint> x = follow_prefix(s, sum.emission, rays);
        if (!x) return sum;
        const SplitRadiance gathered = gather(*x, s.stream, rays);
        const Spectrum delta =
            delta_light(transport_, x->vertex, s.stream.bits(Dim::opacity, 2 * x->path.depth + 1), rays);
        const Spectrum bright = bright_light(*x, s.stream, rays);
        sum.direct = x->path.throughput * (gathered.direct + delta + bright);
        sum.indirect = x->path.throughput * gathered.indirect;
        return sum;
    }

    /// Follows mirrors and smooth glass to a surface that scatters; adds what they show of light to
    /// `emission`.
    std::optional<ShadingPoint> follow_prefix(const CameraSample& s, Spectrum& emission,
                                              RayCounts& rays) const {
        PathState path = s.path;
        while (path.hit && path.depth < longest_prefix) {
            Vertex vertex = make_vertex(transport_, path, s.stream);
            emission += path.throughput * arriving_emission(transport_, path, &vertex.point);
            if (path.depth == max_depth_) return {};
            const float delta = delta_probability(vertex.bsdf, vertex.w_out);
            if (s.stream.next1(Dim::lobe, path.depth) >= delta) {
                path.throughput *= 1 / (1 - delta);
                vertex.bsdf = without_delta(vertex.bsdf);
                return ShadingPoint{path, vertex};
            }
            scatter_path(path, vertex, s.stream);
            if (!path.alive) return {};
            rays.add(RayPurpose::prefix);
            path.hit = transport_.tracer.closest_hit(path.ray);
        }
        if (!path.hit) emission += path.throughput * arriving_emission(transport_, path, nullptr);
        return {};
    }

    /// Random numbers of gather ray `i`: for Sobol points, one sequence over all camera samples of the pixel.
    SampleStream ray_stream(const SampleStream& s, std::uint32_t i) const {
        constexpr std::uint64_t gather_key = 0x676174686572;
        if (s.set == PointSet::sobol)
            return {hash(s.key, gather_key), s.index * rays_ + i, s.count * rays_, s.set};
        return {hash(s.key, gather_key, s.index), i, rays_, s.set};
    }

    /// The direction's random numbers. A square number of stratified rays fills the n × n strata in blocks of
    /// 4 × 4, so that the rays of a packet are neighbours.
    Point2 direction_numbers(const SampleStream& stream, std::uint32_t depth) const {
        const auto n = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(rays_))));
        if (stream.set != PointSet::stratified || n * n != rays_ || n % 4 != 0)
            return stream.next2(Dim::direction, depth);
        const std::uint32_t i = stream.index, block = i / 16;
        const std::uint32_t column = 4 * (block % (n / 4)) + i % 4, row = 4 * (block / (n / 4)) + i / 4 % 4;
        const std::uint64_t jitter = hash(stream.key, i, 2 * depth + 1);
        const auto in_stratum = [&](std::uint32_t stratum, std::uint64_t bits) {
            const float x = (static_cast<float>(stratum) + unit_float(static_cast<std::uint32_t>(bits)))
                            / static_cast<float>(n);
            return std::min(x, 0x1.fffffep-1f);
        };
        return {in_stratum(column, jitter), in_stratum(row, jitter >> 32)};
    }

    SplitRadiance gather(const ShadingPoint& x, const SampleStream& stream, RayCounts& rays) const {
        SplitRadiance sum;
        for (std::uint32_t first = 0; first < rays_; first += packet_size) {
            std::array<GatherRay, packet_size> gather_rays;
            std::array<Ray, packet_size> packet;
            std::array<Hit, packet_size> hits;
            for (std::uint32_t lane = 0; lane < packet_size; ++lane) {
                packet[lane].t_max = -1;
                if (first + lane < rays_)
                    packet[lane] = sample_ray(x, stream, first + lane, gather_rays[lane]);
                if (packet[lane].t_max >= 0) rays.add(RayPurpose::gather);
            }
            transport_.tracer.closest_hits(packet, hits, coherence_);
            add_incident(x, packet, hits, gather_rays, sum, rays);
        }
        const float share = 1 / static_cast<float>(rays_);
        return {{}, sum.direct * share, sum.indirect * share};
    }

    /// Draws gather ray `i` from the BSDF; the returned ray has t_max < 0 where nothing is reflected.
    Ray sample_ray(const ShadingPoint& x, const SampleStream& stream, std::uint32_t i, GatherRay& ray) const {
        const Ray none{{}, {}, -1, 0};
        ray.stream = ray_stream(stream, i);
        const BsdfRandom u{ray.stream.next1(Dim::lobe, x.path.depth),
                           direction_numbers(ray.stream, x.path.depth)};
        const auto scattered = sample(x.vertex.bsdf, x.vertex.w_out, u);
        if (!scattered || is_black(scattered->weight)) return none;
        const WorldDir w_in = x.vertex.point.frame.to_world(scattered->w_in);
        if (!sides_agree(x.vertex.point, w_in)) return none;
        ray.weight = scattered->weight;
        ray.pdf = scattered->pdf;
        return {ray_origin(x.vertex.point, w_in), w_in, infinity,
                ray.stream.bits(Dim::opacity, 2 * x.path.depth + 2)};
    }

    /// Adds what gather rays bring back: light they have hit, and light that the surfaces they have hit
    /// reflect.
    void add_incident(const ShadingPoint& x, const std::array<Ray, packet_size>& packet,
                      const std::array<Hit, packet_size>& hits,
                      const std::array<GatherRay, packet_size>& gather_rays, SplitRadiance& sum,
                      RayCounts& rays) const {
        const std::uint32_t depth = x.path.depth + 1,
                            limit = std::min(max_depth_, saturating_add(depth, source_depth_));
        PathPacket paths;
        StreamPacket streams;
        for (std::size_t i = 0; i < packet_size; ++i) {
            paths[i] = {
                packet[i],           hits[i], depth, 1, gather_rays[i].weight, x.path.eta_scale, 0, false,
                packet[i].t_max >= 0};
            streams[i] = gather_rays[i].stream;
            if (!paths[i].alive) continue;
            sum.direct += emission_of(paths[i], gather_rays[i]);
            paths[i].alive = hits[i] && depth < limit;
        }
        if (depth >= limit) return;
        for (const SplitRadiance& reflected : path_radiance(transport_, paths, limit, streams, rays))
            sum.indirect += reflected.total();
    }

    /// What a gather ray brings straight from a light, times its weight.
    Spectrum emission_of(PathState path, const GatherRay& gather_ray) const {
        const std::optional<Vertex> y =
            path.hit ? std::optional(make_vertex(transport_, path, gather_ray.stream)) : std::nullopt;
        const SurfacePoint* point = y ? &y->point : nullptr;
        const Spectrum emission = arriving_emission(transport_, path, point);
        return is_black(emission) ? emission
                                  : path.throughput * emission * bsdf_share(path.ray, point, gather_ray.pdf);
    }

    /// The balance heuristic's share of BSDF sampling against the samples of the bright light.
    float bsdf_share(const Ray& ray, const SurfacePoint* y, float bsdf_pdf) const {
        if (!bright_lights_) return 1;
        const float light_pdf =
            y ? bright_lights_->pdf(ray.origin, *y) : bright_lights_->environment_pdf(ray.direction);
        const float bsdf_density = static_cast<float>(rays_) * bsdf_pdf;
        return bsdf_density / (bsdf_density + static_cast<float>(light_samples_) * light_pdf);
    }

    /// Samples of the bright part of the light, weighed against the gather rays.
    Spectrum bright_light(const ShadingPoint& x, const SampleStream& stream, RayCounts& rays) const {
        Spectrum sum;
        if (!bright_lights_ || bright_lights_->empty()) return sum;
        for (std::uint32_t i = 0; i < light_samples_; ++i) {
            const SampleStream s{hash(stream.key, 0x627269676874), stream.index * light_samples_ + i,
                                 stream.count * light_samples_, stream.set};
            const auto light =
                bright_lights_->sample(x.vertex.point.position, s.next1(Dim::light_choice, x.path.depth),
                                       s.next2(Dim::light_point, x.path.depth));
            if (!light) continue;
            const Spectrum reflected = unshadowed(x.vertex, *light);
            if (is_black(reflected)) continue;
            if (in_shadow(transport_, x.vertex.point, *light, s.bits(Dim::opacity, 2 * x.path.depth + 1),
                          rays))
                continue;
            const float bsdf_pdf =
                pdf(x.vertex.bsdf, x.vertex.w_out, x.vertex.point.frame.to_local(light->w_in));
            sum += reflected
                   / (static_cast<float>(light_samples_) * light->pdf + static_cast<float>(rays_) * bsdf_pdf);
        }
        return sum;
    }

    const Transport& transport_;
    const View& view_;
    bool surface_layers_;
    std::uint32_t rays_, light_samples_, max_depth_, source_depth_;
    Coherence coherence_;                          // stratified rays are sorted by direction
    std::unique_ptr<LightSampler> bright_lights_;  // only with light samples
};

}  // namespace

std::unique_ptr<Integrator> make_gather(const RenderSettings& settings, const Transport& transport,
                                        const View& view, bool surface_layers) {
    return std::make_unique<Gather>(settings, transport, view, surface_layers);
}

}  // namespace relumine
