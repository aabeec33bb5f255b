// SPDX-License-Identifier: Apache-2.0
// Statistics as JSON; the keys are documented in docs/statistics.md.
#include <nlohmann/json.hpp>

#include "relumine/render.hpp"

namespace relumine {

std::string RenderStats::to_json() const {
    nlohmann::ordered_json json;
    for (const auto& [stage, seconds] : stage_seconds) json["stage_seconds"][stage] = seconds;
    json["total_seconds"] = total_seconds;
    json["cpu_seconds"] = cpu_seconds;
    json["rays"] = rays;
    json["total_rays"] = total_rays;
    json["samples"] = samples;
    json["non_finite_samples"] = non_finite_samples;
    json["non_finite_rays"] = non_finite_rays;
    if (first_non_finite) json["first_non_finite"] = *first_non_finite;
    if (cache) {
        nlohmann::ordered_json& out = json["cache"];
        out["records"] = cache->records;
        out["surfels"] = cache->surfels;
        out["record_bytes"] = cache->record_bytes;
        out["points"] = cache->points;
        out["reprojections"] = cache->reprojections;
        out["gathered"] = cache->gathered;
        out["gap_rays"] = rays.contains("gap") ? rays.at("gap") : 0;
        for (const auto& [step, seconds] : cache->cpu_seconds) out["cpu_seconds"][step] = seconds;
    }
    if (field) {
        nlohmann::ordered_json& out = json["field"];
        out["elements"] = field->elements;
        out["links"] = field->links;
        out["iterations"] = field->iterations;
        out["bytes"] = field->bytes;
        out["unresolved_links"] = field->unresolved_links;
    }
    if (predicted_error) json["predicted_error"] = *predicted_error;
    json["peak_memory_bytes"] = peak_memory_bytes;
    json["threads"] = threads;
    json["stopped"] = stopped;
    json["stopped_by"] = stopped_by.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(stopped_by);
    if (checkpoint)
        json["checkpoint"] = {{"resumed", checkpoint->resumed},
                              {"resumed_samples", checkpoint->resumed_samples},
                              {"earlier_seconds", checkpoint->earlier_seconds},
                              {"written", checkpoint->written},
                              {"failed", checkpoint->failed}};
    return json.dump(2);
}

}  // namespace relumine
