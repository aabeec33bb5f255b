// SPDX-License-Identifier: Apache-2.0
// Light sources of gather rays.
#include "integrators/light_source.hpp"

#include "base/executor.hpp"
#include "integrators/path_tracer.hpp"
#include "integrators/shading_point.hpp"

namespace relumine {
namespace {

/// Places along each side of the full frame from which the field is begun.
int seeds_along(const View& view) { return std::clamp(std::max(view.width, view.height) / 4, 8, 40); }

/// A camera sample in the middle of one of the frame's parts.
CameraSample seed_sample(const View& view, const Tracer& tracer, int column, int row) {
    CameraSample s;
    const auto at = [&](int i, int pixels) {
        return (static_cast<float>(i) + 0.5f) / static_cast<float>(seeds_along(view))
               * static_cast<float>(pixels);
    };
    const Vec2 pixel{at(column, view.width), at(row, view.height)};
    s.x = static_cast<int>(pixel.x);
    s.y = static_cast<int>(pixel.y);
    s.stream = pixel_stream(hash(view.seed, 0x6669656c64), column, row, 0, 1, PointSet::sobol);
    s.path.ray = view.camera.through(pixel);
    s.path.ray.opacity_seed = s.stream.bits(Dim::opacity);
    s.path.hit = tracer.closest_hit(s.path.ray);
    return s;
}

void add_seeds(const Transport& t, const CameraSample& sample, std::uint32_t max_depth,
               std::vector<FieldSeed>& seeds, RayCounts& rays) {
    Spectrum emission;
    const auto x = follow_prefix(t, sample, {max_depth}, emission, rays);
    if (!x) return;
    const SurfacePoint& p = x->vertex.point;
    seeds.push_back({p.position, p.geometric_normal, p.offset});
    if (std::holds_alternative<RoughDielectric>(x->vertex.bsdf))
        seeds.push_back({p.position, -p.geometric_normal, p.offset});
}

/// Of a radiance field while it is built: most of it links, in vectors that grow. 4,100 at the peak of an
/// interior of 15,000 elements.
constexpr std::uint64_t field_bytes_per_element = 6'000;
constexpr std::size_t least_elements = 1000;
constexpr int most_coarsenings = 6;

/// Paths are continued as they are, whatever a field says.
bool is_exact(const RenderSettings& settings) {
    return settings.method == "path" || (settings.method == "cache" && settings.unbiased);
}

}  // namespace

IncidentRadiance incident_source(const RenderSettings& settings, const Transport& transport) {
    return {transport, depth_limit(settings), source_depth(settings.radiance),
            is_exact(settings) ? nullptr : transport.field};
}

bool wants_guide(const RenderSettings& settings) { return settings.guide == "field" && is_exact(settings); }

bool wants_field(const RenderSettings& settings) {
    if (settings.max_depth >= 0 && settings.max_depth < 2) return false;
    if (settings.method == "path") return wants_guide(settings);
    return settings.radiance == "radiosity" || settings.radiance == "auto";
}

std::uint64_t least_field_bytes() { return least_elements * field_bytes_per_element; }

std::unique_ptr<CausticMap> make_caustics(const RenderSettings& settings, const Transport& transport,
                                          const std::function<bool()>& stop, RayCounts& rays) {
    if (settings.photons <= 0 || is_exact(settings) || !has_specular_surfaces(transport.scene)) return {};
    const FlushDenormals flush;
    PhotonSettings photons;
    photons.paths = static_cast<std::uint32_t>(settings.photons);
    photons.seed = settings.seed;
    photons.threads = resolve_threads(settings.threads);
    photons.stop = stop;
    if (settings.max_depth >= 0) photons.most_specular = static_cast<std::uint32_t>(settings.max_depth) - 1;
    return std::make_unique<CausticMap>(trace_photons(transport, photons, rays));
}

std::unique_ptr<RadianceField> make_field(const RenderSettings& settings, const Transport& transport,
                                          const View& view, const std::function<bool()>& stop,
                                          std::uint64_t most_bytes, RayCounts& rays) {
    const FlushDenormals flush;
    std::vector<FieldSeed> seeds;
    for (int row = 0; row < seeds_along(view); ++row)
        for (int column = 0; column < seeds_along(view); ++column) {
            rays.add(RayPurpose::camera);
            add_seeds(transport, seed_sample(view, transport.tracer, column, row), depth_limit(settings),
                      seeds, rays);
        }
    FieldSettings field;
    field.arrivals = wants_guide(settings);
    field.seed = settings.seed;
    field.threads = resolve_threads(settings.threads);
    field.stop = stop;
    // A guide's maps hold what elements receive from others, which is a bounce more.
    const int behind = field.arrivals ? 1 : 2;
    if (settings.max_depth >= 0)
        field.bounces = static_cast<std::uint32_t>(std::max(settings.max_depth - behind, 0));
    const std::uint64_t fit = std::max<std::uint64_t>(most_bytes / field_bytes_per_element, least_elements);
    const bool limited = fit < field.most_elements;
    if (limited) field.most_elements = fit;
    for (int i = 0;; ++i) {
        auto made = std::make_unique<RadianceField>(transport, seeds, field, rays);
        const bool full = made->figures().elements >= field.most_elements;
        if (!limited || !full || i == most_coarsenings || (stop && stop())) return made;
        field.cell *= 2;
    }
}

}  // namespace relumine
