// SPDX-License-Identifier: Apache-2.0
// Memory needs.
#include "memory_needs.hpp"

#include <fmt/format.h>

#include "base/memory.hpp"
#include "film/film.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

/// Code, libraries, threads with what they have at hand: 17 MB are resident before a tiny scene is rendered.
constexpr std::uint64_t program_bytes = 24 << 20;

/// Embree's tree and triangles, and what building them takes: 84 and 120 at the peak for 10⁵ and 10⁶
/// triangles.
constexpr std::uint64_t tree_bytes_per_triangle = 130;

std::uint64_t sum_of(const MemoryNeeds& needs) {
    std::uint64_t sum = 0;
    for (const auto& [purpose, bytes] : needs) sum += bytes;
    return sum;
}

}  // namespace

MemoryNeeds needed_before_building(const Scene& scene, const RenderSettings& settings, const Framing& framing,
                                   bool checkpoint) {
    const SceneInfo info = scene.info();
    const auto pixels = static_cast<std::uint64_t>(framing.window.width())
                        * static_cast<std::uint64_t>(framing.window.height());
    const FilmBytes bytes = film_bytes(pixels, settings.aovs);
    return {{"program", program_bytes},
            {"scene", info.memory_bytes},
            {"acceleration structure", info.triangles * tree_bytes_per_triangle},
            {"film", bytes.film},
            {"picture", bytes.picture},
            {"checkpoint", checkpoint ? 2 * bytes.film : 0},  // a copy, and as a file
            {"smallest radiance field", wants_field(settings) ? least_field_bytes() : 0}};
}

MemoryNeeds needed_with(const Integrator& integrator, const RadianceField* field, const Scene& scene,
                        const RenderSettings& settings, const Framing& framing, bool checkpoint) {
    MemoryNeeds needs = needed_before_building(scene, settings, framing, checkpoint);
    needs.pop_back();  // the field stands
    if (field) needs.emplace_back("radiance field", field->figures().bytes);
    needs.emplace_back("method " + settings.method, integrator.known_bytes());
    return needs;
}

std::uint64_t room_beside(const MemoryNeeds& needs, const RenderControl& control) {
    if (control.memory_limit == 0) return no_limit;
    const std::uint64_t sum = sum_of(needs);
    return control.memory_limit > sum ? control.memory_limit - sum : 0;
}

void check_memory(const RenderControl& control, const MemoryNeeds& needs) {
    if (control.memory_limit == 0) return;
    const std::uint64_t sum = sum_of(needs);
    std::string parts;
    for (const auto& [purpose, bytes] : needs)
        if (bytes > 0) parts += fmt::format("{}{} {}", parts.empty() ? "" : ", ", purpose, bytes);
    if (sum > control.memory_limit)
        throw Error{fmt::format("memory limit: expected at least {} bytes, found {} (needed: {})", sum,
                                control.memory_limit, parts)};
}

}  // namespace relumine
