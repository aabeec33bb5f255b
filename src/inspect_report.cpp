// SPDX-License-Identifier: Apache-2.0
// What the cache did for one point, in numbers.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "inspect_steps.hpp"

namespace relumine {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(Vec3 v) { return {v.x, v.y, v.z}; }
Json spectrum_json(Spectrum s) { return {s.r, s.g, s.b}; }

Json shares_json(const SquareShares& s) {
    return {{"covered", s.covered}, {"unknown", s.unknown}, {"gaps", s.gaps}};
}

/// Layers that hold something, the one at infinity included.
std::size_t layers_in_use(const Surfels& surfels) {
    std::size_t layers = 0;
    for (std::size_t k = 0; k < surfels.layers(); ++k)
        layers += surfels.layer_begin[k] < surfels.layer_begin[k + 1] ? 1 : 0;
    return layers;
}

/// Degrees.
float angle_between(Vec3 a, Vec3 b) { return std::atan2(length(cross(a, b)), dot(a, b)) * 180 * inv_pi; }

Json record_json(const RecordUse& use, const Receiver& receiver) {
    const CacheEntry& entry = *use.found.entry;
    const Record& record = entry.record;
    Json json{{"id", use.found.id},
              {"pixel", {entry.x, entry.y}},
              {"pixel_reach", entry.pixel_reach},
              {"position", vector_json(record.position)},
              {"distance", length(record.position - receiver.position)},
              {"height", dot(record.position - receiver.position, receiver.frame.n)},
              {"normal_angle_degrees", angle_between(record.frame.n, receiver.frame.n)},
              {"unsuitability", use.found.unsuitability},
              {"reach", record.reach},
              {"nearest_distance", record.nearest},  // null where nothing is hit
              {"harmonic_distance", record.harmonic_distance},
              {"side", record.side},
              {"surfels", record.surfels.count},
              {"surfels_at_infinity", record.surfels.count - record.surfels.infinity_begin()},
              {"layers", layers_in_use(record.surfels)},
              {"bytes", record.bytes()},
              {"used", use.used}};
    json["after"] = use.used ? shares_json(use.after) : Json();
    return json;
}

Json records_json(const InspectedPoint& p) {
    Json records = Json::array();
    for (const RecordUse& use : p.records) records.push_back(record_json(use, p.receiver));
    return records;
}

Json scales_json(const std::vector<NamedPicture>& pictures) {
    Json scales = Json::object();
    for (const auto& [name, image] : pictures)
        if (const auto scale = image.metadata.find("scale"); scale != image.metadata.end())
            scales[name] = std::strtod(scale->second.c_str(), nullptr);
    return scales;
}

}  // namespace

std::string report_json(const InspectedPoint& p, const std::vector<NamedPicture>& pictures) {
    const ShadingPoint& x = *p.pixel.point;
    const SurfacePoint& surface = x.vertex.point;
    Json json{{"pixel", {p.x, p.y}},
              {"frame", {p.width, p.height}},
              {"position", vector_json(surface.position)},
              {"geometric_normal", vector_json(surface.geometric_normal)},
              {"shading_normal", vector_json(surface.frame.n)},
              {"material", p.material},
              {"camera_distance", x.distance},
              {"mirrors_before", x.path.depth},
              {"footprint", p.pixel.cache.footprint},
              {"records", records_json(p)},
              {"gap_rays", p.gap_rays.size()},
              {"outgoing_radiance",
               {{"estimate", spectrum_json(p.estimate)},
                {"from_true_hemisphere", spectrum_json(p.from_truth)},
                {"error_of_covered_bits", spectrum_json(p.error_of_covered)},
                {"error_of_gap_bits", spectrum_json(p.error_of_gaps)}}},
              {"picture_scales", scales_json(pictures)}};
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace relumine
