// SPDX-License-Identifier: Apache-2.0
// Light samples, and distances.
#include "radiance/field_survey.hpp"

#include "base/sample_packet_kernel.hpp"
#include "radiance/direct_light.hpp"

namespace relumine {
namespace {

/// Nearest distance that counts, metres: a bound for the logarithm.
constexpr float least_distance = 1e-6f;

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

ElementSurvey survey_element(const Transport& t, Vec3 normal, std::span<const StartPoint> points,
                             ElementId id, const FieldSettings& settings, RayCounts& rays) {
    ElementSurvey survey;
    if (!t.lights.empty()) LightSurvey(t, normal, points, id, settings, rays).run(survey);
    const std::uint64_t seed = hash(settings.seed, 0x64697374);
    survey.distance =
        middle_distance(trace_rays(t, points, id, static_cast<int>(packet_size), seed, rays).hits);
    return survey;
}

}  // namespace relumine
