// SPDX-License-Identifier: Apache-2.0
// What gather rays bring back.
#include "radiance/incident.hpp"

#include "radiance/lobe_walk.hpp"
#include "radiance/radiance_field.hpp"

namespace relumine {
namespace {

/// Most surfaces emit nothing: not worth a vertex.
bool may_emit(const Transport& t, const Hit& hit) {
    const Mesh& mesh = t.scene.meshes[index(t.scene.instances[hit.instance].mesh)];
    return !is_black(t.scene.materials[index(mesh.material)].emission);
}

Spectrum emission_met(const Transport& t, PathState path, const SampleStream& stream) {
    if (!path.hit) return path.throughput * arriving_emission(t, path, nullptr);
    if (!may_emit(t, path.hit)) return {};
    const Vertex y = make_vertex(t, path, stream);  // attenuates its copy of the path
    return path.throughput * arriving_emission(t, path, &y.point);
}

constexpr std::uint32_t first_depth = 1;  // of what the camera's gather rays meet: the field's own

/// What the surfaces at the paths' hits reflect: the field's light by diffuse surfaces, found along lobes.
void add_reflected_field(const IncidentRadiance& source, PathPacket& paths, std::uint32_t limit,
                         const StreamPacket& streams, RadiancePacket& sums, RayCounts& counts) {
    std::array<Spectrum, packet_size> known, found;
    walk_lobes(
        source.transport, paths, {limit}, streams, found, counts,
        [&](std::size_t i, const DiffuseVertex& at) {
            const SurfacePoint& p = at.vertex.point;
            const auto irradiance = source.field->irradiance(p.position, p.geometric_normal, p.frame.n);
            if (irradiance)
                known[i] +=
                    at.weight * *irradiance
                    * (inv_pi
                       * source.field->share_after(paths[i].depth - std::min(paths[i].depth, first_depth)));
            return irradiance.has_value();
        });
    // One ray of a map stands for many: a rare find would be seen as a dot.
    const float most = source.field->most_found();
    for (std::size_t i = 0; i < packet_size; ++i) {
        const float brightness = luminance(found[i]);
        sums[i].indirect = known[i] + (brightness > most ? found[i] * (most / brightness) : found[i]);
    }
}

}  // namespace

std::uint32_t source_depth(const std::string& radiance) {
    if (radiance == "emission") return 0;
    if (radiance == "direct") return 1;
    return unlimited_depth;
}

RadiancePacket incident_radiance(const IncidentRadiance& source, const std::array<Ray, packet_size>& rays,
                                 const std::array<Hit, packet_size>& hits, std::uint32_t depth,
                                 const StreamPacket& streams, RayCounts& counts) {
    const std::uint32_t behind = source.max_depth - std::min(source.max_depth, depth);
    const std::uint32_t limit = depth + std::min(behind, source.source_depth);
    PathPacket paths;
    RadiancePacket sums;
    for (std::size_t i = 0; i < packet_size; ++i) {
        paths[i] = {rays[i], hits[i], depth, 1, Spectrum{1}, 1, 0, false, rays[i].t_max >= 0};
        if (!paths[i].alive) continue;
        tint(source.transport, paths[i]);
        sums[i].direct = emission_met(source.transport, paths[i], streams[i]);
        paths[i].alive = hits[i] && depth < limit;
    }
    if (depth >= limit) return sums;
    if (source.field) {
        add_reflected_field(source, paths, limit, streams, sums, counts);
        return sums;
    }
    RadiancePacket reflected;
    path_radiance(source.transport, {&paths, 1}, limit, {&streams, 1}, {&reflected, 1}, counts);
    for (std::size_t i = 0; i < packet_size; ++i) sums[i].indirect = reflected[i].total();
    return sums;
}

}  // namespace relumine
