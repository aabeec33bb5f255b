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

constexpr std::string_view smallest_field = "smallest radiance field", field_itself = "radiance field",
                           of_method = "method ";

std::uint64_t sum_of(const MemoryNeeds& needs) {
    std::uint64_t sum = 0;
    for (const auto& [purpose, bytes] : needs) sum += bytes;
    return sum;
}

/// What is needed by every method; the difference is what another one may hold.
std::uint64_t least_sum_of(const MemoryNeeds& needs) {
    std::uint64_t sum = 0;
    for (const auto& [purpose, bytes] : needs)
        if (purpose != smallest_field && purpose != field_itself && !purpose.starts_with(of_method))
            sum += bytes;
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
            {std::string(smallest_field), wants_field(settings) ? least_field_bytes() : 0}};
}

MemoryNeeds needed_with(const Integrator& integrator, const RadianceField* field, const Scene& scene,
                        const RenderSettings& settings, const Framing& framing, bool checkpoint) {
    MemoryNeeds needs = needed_before_building(scene, settings, framing, checkpoint);
    needs.pop_back();  // the field stands
    if (field) needs.emplace_back(field_itself, field->figures().bytes);
    needs.emplace_back(std::string(of_method) + settings.method, integrator.known_bytes());
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
    if (sum <= control.memory_limit) return;
    const std::uint64_t least = least_sum_of(needs);
    const std::string way_out =
        least <= control.memory_limit ? fmt::format("; --method path needs {}", least) : "";
    throw Error{fmt::format("memory limit: expected at least {} bytes, found {} (needed: {}){}", sum,
                            control.memory_limit, parts, way_out)};
}

}  // namespace relumine
