// SPDX-License-Identifier: Apache-2.0
// Drawing lights.
#include "shading/light_sampler.hpp"

#include "shading/delta_lights.hpp"
#include "shading/material.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t no_light = 0xffffffffu;
/// With both an environment and local lights, neither gets less than this share of the samples: power says
/// little about which of them a point sees.
constexpr float min_group_share = 0.3f;
/// So that rounding does not make a uniform sky look uneven.
constexpr float flat_margin = 1.0001f;

double mean_of_channels(Spectrum s) { return (double{s.r} + s.g + s.b) / 3; }

/// Mean emission of a triangle, over a fixed pattern where it is textured.
double mean_emission(const SceneData& scene, const Material& material, std::uint32_t instance,
                     std::uint32_t triangle) {
    if (!material.emission_texture) return mean_of_channels(material.emission);
    constexpr int side = 4;
    double sum = 0;
    for (int i = 0; i < side * side; ++i) {
        const Point2 u{(static_cast<float>(i % side) + 0.5f) / side,
                       (static_cast<float>(i / side) + 0.5f) / side};
        const Point2 b = uniform_triangle(u);
        Hit hit;
        hit.u = b.x;
        hit.v = b.y;
        hit.instance = instance;
        hit.triangle = triangle;
        sum += mean_of_channels(material_emission(scene, material, texture_coordinates(scene, hit).uv));
    }
    return sum / (side * side);
}

std::vector<float> normalised_cdf(const std::vector<double>& powers) {
    double total = 0;
    for (const double power : powers) total += power;
    std::vector<float> cdf{0};
    double sum = 0;
    for (const double power : powers) cdf.push_back(static_cast<float>((sum += power) / total));
    return cdf;
}

/// Where in [0, 1) `u` lies of the interval that begins at `first`.
float rescale(float u, float first, float width) {
    return std::clamp((u - first) / width, 0.0f, 0x1.fffffep-1f);
}

/// Density per steradian of a point on a plane that lies `height` below or above the point that sees it.
float solid_angle_density(float per_area, float distance2, float distance, float height) {
    return per_area * distance2 * distance / std::abs(height);
}

}  // namespace

void LightLanes::set(std::size_t i, const LightSample& light) {
    w_in.set(i, light.w_in.v);
    target.set(i, light.target);
    distance[i] = light.distance;
    radiance.set(i, light.radiance);
    pdf[i] = light.pdf;
    delta[i] = light.delta ? -1 : 0;
    drawn[i] = -1;
}

LightSampler::~LightSampler() = default;

LightSampler::LightSampler(const SceneData& scene, const LightSelection& selection) : scene_(scene) {
    std::vector<double> powers;
    first_triangle_.assign(scene.instances.size(), no_light);
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) add_emissive_instance(i, selection, powers);
    places_ = local_.size();
    if (selection.delta_lights) add_delta_lights(powers);
    double local_power = 0;
    for (const double power : powers) local_power += power;
    if (local_power > 0) local_cdf_ = normalised_cdf(powers);
    if (local_power > 0 && places_ >= selection.tree_from) grow_tree(powers);

    double environment_power = 0;
    if (scene.environment) {
        const float mean = EnvironmentLight::mean_radiance(*scene.environment);
        environment_.emplace(*scene.environment, selection.compensate_for_mis ? mean * flat_margin : 0.0f,
                             selection.threshold);
        if (environment_->can_sample()) environment_power = 4 * pi * pi * sqr(scene.bounds.radius()) * mean;
    }
    if (environment_power > 0)
        environment_probability_ =
            local_power <= 0
                ? 1.0f
                : std::clamp(static_cast<float>(environment_power / (environment_power + local_power)),
                             min_group_share, 1 - min_group_share);
    if (local_power > 0) local_probability_ = 1 - environment_probability_;
    for (std::size_t i = 0; i < triangles_.size() && local_power > 0; ++i)
        if (triangles_[i].area > 0)
            triangles_[i].density =
                local_probability_ * (tree_ ? 1 : local_cdf_[i + 1] - local_cdf_[i]) / triangles_[i].area;
}

void LightSampler::add_emissive_instance(std::uint32_t i, const LightSelection& selection,
                                         std::vector<double>& powers) {
    const Mesh& mesh = scene_.meshes[index(scene_.instances[i].mesh)];
    const Material& material = scene_.materials[index(mesh.material)];
    if (mean_of_channels(material.emission) <= std::min(selection.threshold, selection.most_local_threshold))
        return;
    first_triangle_[i] = static_cast<std::uint32_t>(triangles_.size());
    const float winding =
        determinant(scene_.instances[i].world_from_object) < 0 && !scene_.instances[i].identity ? -1.0f
                                                                                                : 1.0f;
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto [a, b, c] = world_triangle(scene_, i, t);
        const Vec3 normal = cross(b - a, c - a) * winding;
        const float area = 0.5f * length(normal);
        triangles_.push_back({a, b - a, c - a, area > 0 ? normalize(normal) : normal, area, 0,
                              rounding_offset({a, b, c}), i, t, material.emission, material.double_sided,
                              material.emission_texture || material.alpha_mode != AlphaMode::opaque});
        local_.push_back({Kind::triangle, static_cast<std::uint32_t>(triangles_.size() - 1)});
        powers.push_back(double{pi} * area * mean_emission(scene_, material, i, t)
                         * (material.double_sided ? 2 : 1));
    }
}

void LightSampler::add_delta_lights(std::vector<double>& powers) {
    for (std::uint32_t i = 0; i < scene_.point_lights.size(); ++i) {
        local_.push_back({Kind::point, i});
        powers.push_back(4 * double{pi} * mean_of_channels(scene_.point_lights[i].intensity));
    }
    for (std::uint32_t i = 0; i < scene_.spot_lights.size(); ++i) {
        const SpotLight& light = scene_.spot_lights[i];
        local_.push_back({Kind::spot, i});
        powers.push_back(2 * double{pi} * (1 - 0.5 * (light.cos_inner + light.cos_outer))
                         * mean_of_channels(light.intensity));
    }
    places_ = local_.size();
    for (std::uint32_t i = 0; i < scene_.directional_lights.size(); ++i) {
        local_.push_back({Kind::directional, i});
        powers.push_back(double{pi} * sqr(scene_.bounds.radius())
                         * mean_of_channels(scene_.directional_lights[i].irradiance));
    }
}

/// Where a light of this power is, and how it shines.
LightBounds LightSampler::bounds_of(const LocalLight& light, double power) const {
    LightBounds b;
    if (light.kind == Kind::triangle) {
        const EmissiveTriangle& t = triangles_[light.index];
        for (const Vec3 corner : {t.corner, t.corner + t.edge1, t.corner + t.edge2}) b.box.add(corner);
        b.normals = {t.normal, 0};
        b.spread = 0.5f * pi;
        b.two_sided = t.double_sided;
        b.intensity = static_cast<float>(power) * inv_pi * (t.double_sided ? 0.5f : 1.0f);
    } else if (light.kind == Kind::point) {
        b.box.add(scene_.point_lights[light.index].position);
        b.normals = {{0, 0, 1}, pi};
        b.spread = 0.5f * pi;
        b.intensity = static_cast<float>(power) * 0.25f * inv_pi;
    } else {
        const SpotLight& spot = scene_.spot_lights[light.index];
        b.box.add(spot.position);
        b.normals = {spot.direction, 0};
        b.spread = std::acos(std::clamp(spot.cos_outer, -1.0f, 1.0f));
        b.intensity = static_cast<float>(mean_of_channels(spot.intensity));
    }
    return b;
}

void LightSampler::grow_tree(const std::vector<double>& powers) {
    std::vector<LightBounds> bounds;
    for (std::size_t i = 0; i < places_; ++i) bounds.push_back(bounds_of(local_[i], powers[i]));
    if (std::ranges::none_of(bounds, [](const LightBounds& b) { return b.intensity > 0; })) return;
    tree_.emplace(bounds);
    tree_probability_ = local_.size() == places_
                            ? 1.0f
                            : std::clamp(local_cdf_[places_], min_group_share, 1 - min_group_share);
}

Spectrum LightSampler::emitted(const EmissiveTriangle& light, const Hit& hit) const {
    if (!light.varies) return light.radiance;
    const Mesh& mesh = scene_.meshes[index(scene_.instances[light.instance].mesh)];
    const Material& material = scene_.materials[index(mesh.material)];
    const TextureCoordinates at = texture_coordinates(scene_, hit);
    return material_emission(scene_, material, at.uv) * opacity(scene_, material, at);
}

void LightSampler::EmissiveTriangle::put(TrianglePointLanes& points, std::size_t lane, float probability,
                                         Point2 u) const {
    points.corner.set(lane, corner);
    points.edge1.set(lane, edge1);
    points.edge2.set(lane, edge2);
    points.normal.set(lane, normal);
    points.density[lane] = density * probability;
    points.offset[lane] = offset;
    points.radiance.set(lane, radiance);
    points.double_sided[lane] = double_sided ? -1 : 0;
    points.u_x[lane] = u.x;
    points.u_y[lane] = u.y;
    points.chosen[lane] = -1;
}

const LightSampler::EmissiveTriangle* LightSampler::even_triangle(std::size_t chosen) const {
    const LocalLight& light = local_[chosen];
    if (light.kind != Kind::triangle || triangles_[light.index].varies) return nullptr;
    return &triangles_[light.index];
}

std::optional<LightSample> LightSampler::sample_triangle(const EmissiveTriangle& light, float probability,
                                                         Vec3 from, Point2 u) const {
    const Point2 b = uniform_triangle(u);
    const Vec3 point = light.corner + light.edge1 * b.x + light.edge2 * b.y;
    const Vec3 to_light = point - from;
    const float distance2 = length_squared(to_light), height = dot(to_light, light.normal);
    const bool front = height < 0;
    if (height == 0 || !(distance2 > 0) || (!front && !light.double_sided)) return {};
    const float distance = std::sqrt(distance2);
    const float density = solid_angle_density(light.density * probability, distance2, distance, height);
    if (!(density > 0)) return {};
    return LightSample{{to_light / distance},
                       point + light.normal * (front ? light.offset : -light.offset),
                       distance,
                       emitted(light, {distance, b.x, b.y, light.instance, light.triangle}),
                       density};
}

std::size_t LightSampler::choose_by_power(float u) const {
    // Finds what upper_bound would, without branches that depend on u: they could not be predicted.
    std::size_t first = 0;
    for (std::size_t count = local_.size(); count > 1;) {
        const std::size_t half = count / 2;
        first += local_cdf_[first + half] <= u ? half : 0;
        count -= half;
    }
    return first;
}

std::optional<LightSampler::LocalChoice> LightSampler::choose_local(Vec3 from, float u) const {
    if (!tree_) {
        const std::size_t chosen = choose_by_power(u);
        return LocalChoice{chosen, 1,
                           rescale(u, local_cdf_[chosen], local_cdf_[chosen + 1] - local_cdf_[chosen])};
    }
    if (u < tree_probability_) {
        const auto drawn = tree_->sample(from, rescale(u, 0, tree_probability_));
        if (!drawn) return {};
        return LocalChoice{drawn->light, tree_probability_ * drawn->probability, drawn->u};
    }
    const float near = local_cdf_[places_];  // directional lights lie above, by power
    u = std::min(lerp(near, 1.0f, rescale(u, tree_probability_, 1 - tree_probability_)), 0x1.fffffep-1f);
    const std::size_t chosen = choose_by_power(u);
    const float share = local_cdf_[chosen + 1] - local_cdf_[chosen];
    return LocalChoice{chosen, (1 - tree_probability_) * share / (1 - near),
                       rescale(u, local_cdf_[chosen], share)};
}

std::optional<LightSample> LightSampler::sample_local(const LocalChoice& chosen, Vec3 from, Point2 u) const {
    const LocalLight& light = local_[chosen.light];
    if (light.kind == Kind::triangle)
        return sample_triangle(triangles_[light.index], chosen.probability, from, u);
    const float probability =
        local_probability_
        * (tree_ ? chosen.probability : local_cdf_[chosen.light + 1] - local_cdf_[chosen.light]);
    std::optional<LightSample> sample;
    if (light.kind == Kind::point) sample = light_sample(scene_.point_lights[light.index], from);
    if (light.kind == Kind::spot) sample = light_sample(scene_.spot_lights[light.index], from);
    if (light.kind == Kind::directional) sample = light_sample(scene_.directional_lights[light.index]);
    if (sample) sample->pdf = probability;
    return sample;
}

std::optional<LightSample> LightSampler::sample_environment(Point2 u) const {
    const EnvironmentSample drawn = environment_->sample(u);
    if (!(drawn.pdf > 0)) return {};
    return LightSample{drawn.direction,
                       {},
                       infinity,
                       environment_->radiance(drawn.direction),
                       environment_probability_ * drawn.pdf};
}

std::optional<LightSample> LightSampler::sample(Vec3 from, float u_choice, Point2 u) const {
    if (u_choice < environment_probability_) return sample_environment(u);
    if (local_probability_ <= 0) return {};
    const auto chosen = choose_local(from, rescale(u_choice, environment_probability_, local_probability_));
    return chosen ? sample_local(*chosen, from, u) : std::nullopt;
}

std::optional<LightSample> LightSampler::sample(Vec3 from, Point2 u) const {
    if (u.x < environment_probability_)
        return sample_environment({rescale(u.x, 0, environment_probability_), u.y});
    if (local_probability_ <= 0) return {};
    const auto chosen = choose_local(from, rescale(u.x, environment_probability_, local_probability_));
    return chosen ? sample_local(*chosen, from, {chosen->u, u.y}) : std::nullopt;
}

void LightSampler::sample(const Vec3Lanes& from, const Lanes<float>& u_x, const Lanes<float>& u_y,
                          const LaneMask& lanes, LightLanes& samples) const {
    TrianglePointLanes points;
    points.chosen.fill(0);
    samples.drawn.fill(0);
    bool any_triangle = false;
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (lanes[i] == 0) continue;
        const Point2 u{u_x[i], u_y[i]};
        if (u.x >= environment_probability_ && local_probability_ > 0) {
            const auto chosen =
                choose_local(from[i], rescale(u.x, environment_probability_, local_probability_));
            if (!chosen) continue;
            const Point2 left{chosen->u, u.y};
            if (const EmissiveTriangle* triangle = even_triangle(chosen->light)) {
                triangle->put(points, i, chosen->probability, left);
                any_triangle = true;
            } else if (const auto drawn = sample_local(*chosen, from[i], left)) {
                samples.set(i, *drawn);
            }
        } else if (const auto drawn = sample(from[i], u)) {
            samples.set(i, *drawn);
        }
    }
    if (any_triangle) sample_triangles(points, from, samples);
}

float LightSampler::pdf(Vec3 from, const SurfacePoint& hit) const {
    const std::uint32_t first = first_triangle_[hit.instance];
    if (first == no_light) return 0;
    const EmissiveTriangle& light = triangles_[first + hit.triangle];
    const Vec3 to_light = hit.position - from;
    const float distance2 = length_squared(to_light), height = dot(to_light, light.normal);
    if (height == 0) return 0;
    const float chosen = tree_ ? tree_probability_ * tree_->probability(from, first + hit.triangle) : 1;
    return solid_angle_density(light.density * chosen, distance2, std::sqrt(distance2), height);
}

float LightSampler::environment_pdf(WorldDir direction) const {
    return environment_probability_ > 0 ? environment_probability_ * environment_->pdf(direction) : 0.0f;
}

Spectrum LightSampler::environment_radiance(WorldDir direction) const {
    return environment_ ? environment_->radiance(direction) : Spectrum{};
}

float bright_threshold(const SceneData& scene, float factor) {
    if (scene.environment) return factor * EnvironmentLight::mean_radiance(*scene.environment);
    return 0;  // every emitter stands out against black
}

}  // namespace relumine
