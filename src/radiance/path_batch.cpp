// SPDX-License-Identifier: Apache-2.0
// Following paths, many at a time.
#include "base/sample_packet_kernel.hpp"
#include "radiance/direct_light.hpp"
#include "radiance/path_lanes.hpp"
#include "radiance/radiance_field.hpp"
#include "shading/material.hpp"

namespace relumine {
namespace {

constexpr std::size_t least_packet = 8;  // fewer rays are faster one by one

/// What one step of a packet of paths draws, except what few materials ask for.
struct StepNumbers {
    Lanes<float> light_x, light_y;
    Lanes<std::uint32_t> shadow_opacity{};
    ScatterNumbers scatter;

    StepNumbers(const SamplePacket& samples, std::uint32_t depth, bool opacity) {
        samples.next2(Dim::light_point, depth, light_x, light_y);
        samples.next1(Dim::lobe, depth, scatter.lobe);
        samples.next2(Dim::direction, depth, scatter.direction_x, scatter.direction_y);
        scatter.may_end = may_end(depth + 1);
        scatter.max_survival = max_survival(depth + 1);
        if (scatter.may_end) samples.next1(Dim::roulette, depth + 1, scatter.roulette);
        if (!opacity) return;
        samples.bits(Dim::opacity, 2 * depth + 1, shadow_opacity);
        samples.bits(Dim::opacity, 2 * depth + 2, scatter.opacity_seed);
    }

    [[nodiscard]] LightRandom light(std::size_t lane) const {
        return {{light_x[lane], light_y[lane]}, shadow_opacity[lane]};
    }
    [[nodiscard]] BsdfRandom bsdf(std::size_t lane) const {
        return {scatter.lobe[lane], {scatter.direction_x[lane], scatter.direction_y[lane]}};
    }
};

/// Where a path comes from: its place in the batch as it was given.
struct PathId {
    std::uint32_t packet, lane;
};

/// Sixteen paths, their random numbers and where they come from.
struct WalkPacket {
    PathLanes paths;
    SamplePacket samples;
    std::array<PathId, packet_size> ids;

    WalkPacket(const PathPacket& given, const StreamPacket& streams, std::uint32_t packet)
        : samples(streams) {
        for (std::uint32_t i = 0; i < packet_size; ++i) {
            paths.set(i, given[i]);
            ids[i] = {packet, i};
        }
    }
    void take(std::size_t lane, WalkPacket& other, std::size_t other_lane) {
        paths.take(lane, other.paths, other_lane);
        samples.take(lane, other.samples, other_lane);
        ids[lane] = other.ids[other_lane];
        other.paths.alive[other_lane] = 0;
    }
};

/// Rays towards lights of many packets, until there are sixteen.
struct ShadowQueue {
    ShadowLanes lanes;
    std::array<PathId, packet_size> ids;
    std::size_t size = 0;
};

/// Paths on their way, and what a step of them needs.
class PathBatch {
  public:
    PathBatch(const Transport& t, std::span<const PathPacket> paths, std::uint32_t max_depth,
              std::span<const StreamPacket> streams, std::span<RadiancePacket> sums, RayCounts& rays);
    void follow();

  private:
    void step(WalkPacket& packet);
    [[nodiscard]] bool arrive(WalkPacket& packet, std::size_t lane);
    void step_plain(WalkPacket& packet, const LaneMask& plain, const StepNumbers& numbers);
    [[nodiscard]] std::optional<PathGuide> guide_at(const Vertex& vertex) const;
    void advance(WalkPacket& packet, std::size_t lane, const StepNumbers& numbers);
    [[nodiscard]] SplitRadiance& sum_of(PathId id) { return sums_[id.packet][id.lane]; }
    void add_emission(const WalkPacket& packet, std::size_t lane, const SurfacePoint* hit_point);
    void enqueue_shadows(const WalkPacket& packet);
    void add_unshadowed();
    void add_passed(std::size_t active);
    void close_ranks();
    void trace_bounces(WalkPacket& packet);
    void tint_bounces(PathLanes& paths) const;

    const Transport& t_;
    const std::uint32_t max_depth_;
    const bool guided_;  // whether a field knows where light comes from
    std::span<const StreamPacket> streams_;
    std::span<RadiancePacket> sums_;
    RayCounts& rays_;
    std::uint32_t depth_ = 0;  // scattering vertices of the paths that live
    std::vector<WalkPacket> packets_;
    TriangleLanes triangles_{};
    VertexLanes vertices_;
    LayerLanes layers_{};
    LightLanes lights_{};
    ShadowLanes shadows_{};
    ShadowQueue queue_;
};

PathBatch::PathBatch(const Transport& t, std::span<const PathPacket> paths, std::uint32_t max_depth,
                     std::span<const StreamPacket> streams, std::span<RadiancePacket> sums, RayCounts& rays)
    : t_(t), max_depth_(max_depth), guided_(t.guide != nullptr), streams_(streams), sums_(sums), rays_(rays) {
    packets_.reserve(paths.size());
    for (std::uint32_t p = 0; p < paths.size(); ++p) {
        packets_.emplace_back(paths[p], streams[p], p);
        for (const PathState& path : paths[p])
            if (path.alive) depth_ = path.depth;
    }
}

void PathBatch::follow() {
    for (close_ranks(); !packets_.empty(); close_ranks()) {
        for (WalkPacket& packet : packets_) step(packet);
        add_unshadowed();
        ++depth_;
        close_ranks();
        for (WalkPacket& packet : packets_) trace_bounces(packet);
    }
}

void PathBatch::add_emission(const WalkPacket& packet, std::size_t i, const SurfacePoint* hit_point) {
    const PathState path = packet.paths.get(i, depth_);
    add(sum_of(packet.ids[i]), path.scatterings, path.throughput * arriving_emission(t_, path, hit_point));
}

/// Counts what a path's ray brings straight from light and fills the lane with the surface that it met. False
/// where that is not one that the kernels know; nothing has been done then.
bool PathBatch::arrive(WalkPacket& packet, std::size_t i) {
    const PathLanes& paths = packet.paths;
    const Hit hit = paths.hit[i];
    const Mesh& mesh = t_.scene.meshes[index(t_.scene.instances[hit.instance].mesh)];
    const MetallicRoughness* layers = t_.uniform_bsdfs.find_layers(mesh.material);
    if (!layers || !mesh.colors.empty() || guided_) return false;
    if (paths.count_emission[i] != 0 && !is_black(t_.scene.materials[index(mesh.material)].emission)) {
        const SurfacePoint point = surface_point(t_.scene, hit, {-paths.ray.direction[i]});
        add_emission(packet, i, &point);
    }
    const ShadingTriangle triangle = shading_triangle(t_.scene, hit);
    triangles_.set(i, triangle, hit, paths.ray.direction[i]);
    layers_.set(i, *layers);
    if (is_anisotropic(layers->ggx)) set_anisotropy(i, triangle.lobe_axis, layers->ggx, triangles_, layers_);
    layers_.specular = layers_.specular || !is_black(layers->specular_f90);
    return true;
}

std::optional<PathGuide> PathBatch::guide_at(const Vertex& vertex) const {
    if (!guided_ || is_delta(vertex.bsdf)) return {};
    return PathGuide(t_.guide->arrivals(vertex.point.position, vertex.point.geometric_normal), vertex);
}

/// A step of one path whose surface the kernels do not know: counts emission, proposes direct light,
/// scatters.
void PathBatch::advance(WalkPacket& packet, std::size_t i, const StepNumbers& numbers) {
    PathState path = packet.paths.get(i, depth_);
    const PathId id = packet.ids[i];
    const Vertex vertex = make_vertex(t_, path, streams_[id.packet][id.lane]);
    if (path.count_emission)
        add(sum_of(id), path.scatterings, path.throughput * arriving_emission(t_, path, &vertex.point));
    path.alive = depth_ < max_depth_;
    const std::optional<PathGuide> guide = guide_at(vertex);
    if (path.alive && !is_delta(vertex.bsdf)) {
        if (const auto light =
                propose_direct_light(t_, vertex, numbers.light(i), guide ? &*guide : nullptr)) {
            shadows_.rays.set(i, light->shadow_ray);
            shadows_.radiance.set(i, path.throughput * light->reflected);
            shadows_.scatterings[i] = path.scatterings + 1;
        }
    }
    if (path.alive) {
        scatter(path, vertex,
                guide ? guide->sample(vertex, numbers.bsdf(i))
                      : sample(vertex.bsdf, vertex.w_out, numbers.bsdf(i)),
                numbers.scatter.opacity_seed[i]);
        path.sky_pdf = guide ? guide->sky_pdf(path.ray.direction) : 0;
        path.light_share = guide ? guide->light_share() : 1;
        path.alive = path.alive && survives(path, numbers.scatter.roulette[i]);
    }
    packet.paths.set(i, path);
}

/// A step of the lanes that `arrive` has filled.
void PathBatch::step_plain(WalkPacket& packet, const LaneMask& plain, const StepNumbers& numbers) {
    PathLanes& paths = packet.paths;
    if (depth_ >= max_depth_) {
        for (std::size_t i = 0; i < packet_size; ++i) paths.alive[i] &= ~plain[i];
        return;
    }
    locate(triangles_, vertices_);
    t_.lights.sample(vertices_.position, numbers.light_x, numbers.light_y, plain, lights_);
    propose_direct_light(vertices_, layers_, lights_, paths.throughput, shadows_);
    scatter(vertices_, layers_, numbers.scatter, plain, paths);
    for (std::size_t i = 0; i < packet_size; ++i) {
        shadows_.scatterings[i] = paths.scatterings[i] + 1;
        shadows_.rays.opacity_seed[i] = numbers.shadow_opacity[i];
        if (plain[i] == 0) continue;
        ++paths.scatterings[i];
        paths.count_emission[i] = -1;
        paths.ray.opacity_seed[i] = numbers.scatter.opacity_seed[i];
    }
}

/// One step of sixteen paths at their hits; their bounces are not traced yet.
void PathBatch::step(WalkPacket& packet) {
    PathLanes& paths = packet.paths;
    const StepNumbers numbers(packet.samples, depth_, t_.tracer.asks_for_opacity());
    LaneMask plain{}, other{};
    bool any_plain = false;
    layers_.specular = layers_.stretched = triangles_.oriented = false;
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (paths.alive[i] == 0) continue;
        if (paths.hit.instance[i] == no_instance) {
            if (paths.count_emission[i] != 0) add_emission(packet, i, nullptr);
            paths.alive[i] = 0;
        } else if (arrive(packet, i)) {
            plain[i] = -1;
            any_plain = true;
        } else {
            other[i] = -1;
        }
    }
    shadows_.rays.t_max.fill(-1);
    if (any_plain) step_plain(packet, plain, numbers);
    for (std::size_t i = 0; i < packet_size; ++i)
        if (other[i] != 0) advance(packet, i, numbers);
    enqueue_shadows(packet);
}

/// Puts the proposals' rays of a packet in line; traces as often as there are sixteen.
void PathBatch::enqueue_shadows(const WalkPacket& packet) {
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (shadows_.rays.t_max[i] < 0) continue;
        queue_.lanes.take(queue_.size, shadows_, i);
        queue_.ids[queue_.size] = packet.ids[i];
        if (++queue_.size == packet_size) add_unshadowed();
    }
}

/// Traces the rays in line and adds what is not blocked.
void PathBatch::add_unshadowed() {
    const std::size_t active = queue_.size;
    ShadowLanes& shadows = queue_.lanes;
    rays_.add(RayPurpose::shadow, active);
    for (std::size_t i = active; i < packet_size; ++i) shadows.rays.t_max[i] = -1;
    queue_.size = 0;
    if (t_.tracer.has_panes()) return add_passed(active);
    LaneMask blocked;
    if (active >= least_packet) t_.tracer.occluded(shadows.rays, blocked);
    for (std::size_t i = 0; i < active; ++i) {
        if (active < least_packet) blocked[i] = t_.tracer.occluded(shadows.rays[i]) ? -1 : 0;
        if (blocked[i] == 0) add(sum_of(queue_.ids[i]), shadows.scatterings[i], shadows.radiance[i]);
    }
}

/// The same with panes in the scene.
void PathBatch::add_passed(std::size_t active) {
    const ShadowLanes& shadows = queue_.lanes;
    SpectrumLanes passed;
    if (active >= least_packet) t_.tracer.passed_light(shadows.rays, passed);
    for (std::size_t i = 0; i < active; ++i) {
        if (active < least_packet) passed.set(i, t_.tracer.passed_light(shadows.rays[i]));
        add(sum_of(queue_.ids[i]), shadows.scatterings[i], shadows.radiance[i] * passed[i]);
    }
}

/// Where that saves packets, moves the last living paths into the places of those that have ended.
void PathBatch::close_ranks() {
    std::size_t living = 0;
    for (const WalkPacket& packet : packets_)
        for (const std::int32_t alive : packet.paths.alive) living += alive != 0 ? 1 : 0;
    const std::size_t needed = (living + packet_size - 1) / packet_size;
    if (needed == packets_.size()) return;
    const auto alive = [&](std::size_t place) {
        return packets_[place / packet_size].paths.alive[place % packet_size] != 0;
    };
    std::size_t hole = 0;
    for (std::size_t last = packets_.size() * packet_size; last > needed * packet_size;) {
        if (!alive(--last)) continue;
        while (alive(hole)) ++hole;
        packets_[hole / packet_size].take(hole % packet_size, packets_[last / packet_size],
                                          last % packet_size);
    }
    packets_.erase(packets_.begin() + static_cast<std::ptrdiff_t>(needed), packets_.end());
}

void PathBatch::trace_bounces(WalkPacket& packet) {
    PathLanes& paths = packet.paths;
    std::size_t active = 0;
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (paths.alive[i] == 0) paths.ray.t_max[i] = -1;
        active += paths.alive[i] != 0 ? 1 : 0;
    }
    rays_.add(RayPurpose::bounce, active);
    if (active >= least_packet)
        t_.tracer.closest_hits(paths.ray, paths.hit, Coherence::incoherent);
    else
        for (std::size_t i = 0; i < packet_size; ++i)
            if (paths.alive[i] != 0) paths.hit.set(i, t_.tracer.closest_hit(paths.ray[i]));
    if (t_.tracer.has_coloured_panes()) tint_bounces(paths);
}

/// Gives the paths the colours of the panes that their rays have passed.
void PathBatch::tint_bounces(PathLanes& paths) const {
    for (std::size_t i = 0; i < packet_size; ++i) {
        if (paths.alive[i] == 0) continue;
        const float t = paths.hit.instance[i] == no_instance ? infinity : paths.hit.t[i];
        paths.throughput.set(i, paths.throughput[i] * t_.tracer.tint(paths.ray[i], t));
    }
}

}  // namespace

void path_radiance(const Transport& t, std::span<const PathPacket> paths, std::uint32_t max_depth,
                   std::span<const StreamPacket> streams, std::span<RadiancePacket> sums, RayCounts& rays) {
    PathBatch(t, paths, max_depth, streams, sums, rays).follow();
}

}  // namespace relumine
