// SPDX-License-Identifier: Apache-2.0
// The body of the public inspect(): one pixel's way through the cache, and what tracing finds instead.
#include "relumine/inspect.hpp"

#include <fmt/format.h>

#include "base/executor.hpp"
#include "base/memory.hpp"
#include "base/message.hpp"
#include "base/rgbe.hpp"
#include "inspect_steps.hpp"
#include "integrators/cached_gather.hpp"
#include "integrators/light_source.hpp"
#include "integrators/path_tracer.hpp"
#include "radiance/direct_light.hpp"
#include "relumine/error.hpp"
#include "render_setup.hpp"

namespace relumine {
namespace {

constexpr std::uint64_t truth_purpose = 0x7472757468;

/// The settings of the picture whose pixel is inspected.
RenderSettings reprojecting(RenderSettings settings) {
    settings.method = "reproject";
    settings.crop.reset();
    settings.aovs.clear();
    validate(settings);
    if (settings.cache_scope == "image") return settings;
    throw SettingsError{expected_found("cache scope", "image, whose records any pixel may use",
                                       "\"" + settings.cache_scope + "\"")};
}

Framing frame_of_pixel(const SceneData& scene, const RenderSettings& settings, int x, int y) {
    Framing framing = find_framing(scene, settings);
    if (x < 0 || y < 0 || x >= framing.width || y >= framing.height)
        throw SettingsError{expected_found("pixel",
                                           fmt::format("0,0 to {},{}", framing.width - 1, framing.height - 1),
                                           fmt::format("{},{}", x, y))};
    framing.window = {x, y, x + 1, y + 1};
    return framing;
}

void check_pixel(const GBufferPixel& pixel, int x, int y) {
    const std::string where = fmt::format("pixel {},{}", x, y);
    if (!pixel.point)
        throw Error{expected_found(
            where, "a surface that gathers light, seen from the camera or through mirrors", "none")};
    if (pixel.reflects_alone) return;
    throw Error{
        expected_found(where, "a surface that is lit from records",
                       fmt::format("one that transmits light (material \"{}\"), which is gathered by rays",
                                   pixel.point->vertex.point.material->name))};
}

SquareShares shares_of(const Reprojection& r) {
    const auto share = [](int bits) { return static_cast<float>(bits) / mask_bits; };
    const int covered = r.covered.count(), unknown = r.unknown.count();
    return {share(covered), share(unknown), share(mask_bits - covered - unknown)};
}

/// The steps of CachedGather for one pixel, one function each.
class Inspector {
  public:
    Inspector(const RenderSetup& setup, const RenderSettings& settings, int x, int y)
        : setup_(setup),
          max_depth_(depth_limit(settings)),
          threads_(resolve_threads(settings.threads)),
          source_(incident_source(settings, setup.transport)),
          settings_(cache_settings(settings)) {
        p_.x = x;
        p_.y = y;
        p_.width = setup.view.width;
        p_.height = setup.view.height;
    }

    [[nodiscard]] InspectedPoint run() {
        place();
        const FlushDenormals flush;
        look_up();
        reproject_records();
        fill();
        trace_truth();
        reflect();
        return std::move(p_);
    }

  private:
    void place() {
        const GBuffer points(setup_.transport, setup_.view, placement_region(setup_.view, 0), 0, {max_depth_},
                             false, threads_, rays_);
        p_.pixel = points.at(p_.x, p_.y);
        check_pixel(p_.pixel, p_.x, p_.y);
        p_.material = vertex().point.material->name;
        const auto point_at = [&](int x, int y) {
            const GBufferPixel& pixel = points.at(x, y);
            return pixel.reflects_alone ? &pixel.cache : nullptr;
        };
        PlacementRun run{threads_, {}, {}, {}};
        place_records(source_, points.region(), point_at, settings_, RadianceCache(), p_.cache, run);
    }

    void look_up() {
        const CachePoint& point = p_.pixel.cache;
        p_.receiver = {point.gather.position, point.gather.frame};
        const RadianceCache* const cache = &p_.cache;
        std::vector<FoundRecord> found;
        const Query query{p_.receiver, p_.x, p_.y};
        find_records({&cache, 1}, query, settings_.reuse, found);
        if (found.empty()) {  // placement leaves no point without; the method would do the same
            p_.cache.add(make_entry(source_, point, 0, settings_, rays_, counts_));
            find_records({&cache, 1}, query, settings_.reuse, found);
        }
        for (const FoundRecord& record : found) p_.records.push_back({record, false, {}});
        p_.receiver.frame = receiver_frame(p_.best_record().frame, p_.receiver.frame.n);
    }

    void reproject_records() {
        p_.filled.clear(source_.reflects());
        for (RecordUse& record : p_.records) {
            reproject(record.found.entry->record, p_.receiver, p_.filled);
            record.used = true;
            record.after = shares_of(p_.filled);
            if (static_cast<float>(p_.filled.gaps()) / mask_bits <= settings_.enough_gaps) break;
        }
        p_.covered = p_.filled.covered;
        p_.unknown = p_.filled.unknown;
        p_.filled.blacken();
        p_.reprojected = p_.filled.radiance;
    }

    void fill() {
        fill_gaps(source_, gather_point(), settings_.gap_cell, gap_key(p_.pixel.cache), p_.filled,
                  p_.gap_rays, rays_);
    }

    void trace_truth() {
        p_.truth.clear(source_.reflects());
        p_.truth.covered = p_.truth.lit = ~Mask{};
        const std::vector<TexelSample> texels = trace_hemisphere(
            source_, gather_point(), mask_side, hash(p_.pixel.cache.key, truth_purpose), rays_);
        for (std::size_t i = 0; i < texels.size(); ++i) {
            p_.truth.radiance[i] = pack_rgbe(texels[i].radiance);
            if (source_.reflects()) p_.truth.direct[i] = pack_rgbe(texels[i].direct);
        }
    }

    void reflect() {
        const ReceiverBsdf bsdf = *receiver_bsdf(vertex(), p_.receiver.frame);
        p_.estimate = outgoing(shade(p_.filled, bsdf, p_.bsdf));
        tabulate(bsdf, all_cells, p_.bsdf);
        p_.from_truth = outgoing(shade(p_.truth, p_.bsdf));
        const Spectrum throughput = p_.pixel.point->path.throughput;
        p_.error_of_covered =
            throughput * (reflected_in(p_.covered, p_.filled) - reflected_in(p_.covered, p_.truth));
        p_.error_of_gaps =
            throughput * (reflected_in(~p_.covered, p_.filled) - reflected_in(~p_.covered, p_.truth));
    }

    /// As CachedGather adds it up, to the bit.
    [[nodiscard]] Spectrum outgoing(const ReflectedRadiance& gathered) {
        const ShadingPoint& x = *p_.pixel.point;
        const Spectrum delta = delta_light(setup_.transport, x.vertex,
                                           p_.pixel.stream.bits(Dim::opacity, 2 * x.path.depth + 1), rays_);
        const Spectrum caustics = caustic_light(setup_.transport, x.vertex, x.path.depth, max_depth_);
        const SplitRadiance sum{p_.pixel.emission, x.path.throughput * (gathered.direct + delta),
                                x.path.throughput * (gathered.total - gathered.direct + caustics)};
        return sum.total();
    }

    /// What the point reflects of the light through some bits.
    [[nodiscard]] Spectrum reflected_in(const Mask& bits, Reprojection incident) const {
        for (int y = 0; y < mask_side; ++y)
            for (int x = 0; x < mask_side; ++x)
                if (!bits.test(x, y)) incident.radiance[static_cast<std::size_t>(y * mask_side + x)] = 0;
        return shade(incident, p_.bsdf).total;
    }

    [[nodiscard]] const Vertex& vertex() const { return p_.pixel.point->vertex; }

    [[nodiscard]] GatherPoint gather_point() const {
        GatherPoint point = p_.pixel.cache.gather;
        point.frame = p_.receiver.frame;
        return point;
    }

    const RenderSetup& setup_;
    std::uint32_t max_depth_;
    int threads_;
    IncidentRadiance source_;
    CacheSettings settings_;
    InspectedPoint p_;
    RayCounts rays_;
    CacheCounts counts_;
};

}  // namespace

Inspection inspect(const Scene& scene, const RenderSettings& wanted, int x, int y) {
    const RenderSettings settings = reprojecting(wanted);
    const Framing framing = frame_of_pixel(scene.data(), settings, x, y);
    RenderSetup setup(scene.data(), settings, framing, [](const char*) {});
    RayCounts field_rays;
    if (wants_field(settings)) setup.add_field(settings, {}, no_limit, field_rays);
    const InspectedPoint point = Inspector(setup, settings, x, y).run();
    Inspection inspection{draw_pictures(point), {}};
    inspection.report_json = report_json(point, inspection.pictures);
    return inspection;
}

}  // namespace relumine
