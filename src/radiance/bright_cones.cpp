// SPDX-License-Identifier: Apache-2.0
// Grouping bright elements, and drawing directions towards them.
#include "radiance/bright_cones.hpp"

#include <map>
#include <tuple>

#include "base/assert.hpp"
#include "shading/sampling.hpp"

namespace relumine {
namespace {

constexpr float half_diagonal = 0.8661f;  // of a cube of side 1
constexpr float near = 1.5f;              // radii within which a sphere's cone is no help
constexpr float cosine_margin = 1e-5f;    // so that rounding never leaves the rim out

struct Group {
    Bounds3 box;
    float power = 0;
};

/// Bright elements by cubes of `side`, in a fixed order.
std::vector<Group> groups_of(const FieldCells& cells, std::span<const float> radiosity, float side) {
    std::map<std::tuple<int, int, int>, Group> groups;
    for (std::size_t i = 0; i < cells.elements().size(); ++i) {
        const FieldElement& e = cells.elements()[i];
        if (!e.bright) continue;
        const auto cube = [&](float x) { return static_cast<int>(std::floor(x / side)); };
        Group& group = groups[{cube(e.position.x), cube(e.position.y), cube(e.position.z)}];
        const Vec3 middle = cells.middle_of(e), half = Vec3{0.5f, 0.5f, 0.5f} * e.size;
        group.box.add(middle - half);
        group.box.add(middle + half);
        group.power += radiosity[i] * sqr(e.size);
    }
    std::vector<Group> all;
    for (const auto& [cube, group] : groups) all.push_back(group);
    return all;
}

float cone_pdf(float one_less_cosine) { return 1 / (2 * pi * one_less_cosine); }

}  // namespace

BrightCones::BrightCones(const FieldCells& cells, std::span<const float> radiosity) {
    std::vector<Group> groups;
    for (float side = 4 * cells.scale().size;; side *= 1.5f) {
        groups = groups_of(cells, radiosity, side);
        if (groups.size() <= most) break;
    }
    for (const Group& g : groups) spheres_.push_back({g.box.center(), g.box.radius() * 1.001f, g.power});
}

BrightCones::Table BrightCones::seen_from(Vec3 position, Vec3 normal) const {
    Table table;
    float total = 0;
    for (const Sphere& s : spheres_) {
        const Vec3 way = s.center - position;
        if (dot(way, normal) < -s.radius) continue;
        const float distance2 = length_squared(way), distance = std::sqrt(distance2);
        table.inside = table.inside || distance < near * s.radius;
        const bool around = distance <= s.radius;
        table.axis[table.count] = around ? normal : way / distance;
        const float sine2 = around ? 1 : sqr(s.radius) / distance2;
        // 1 − √(1 − s²) without cancellation.
        table.one_less_cosine[table.count] =
            around ? 2.0f : std::min(sine2 / (1 + std::sqrt(1 - sine2)) + cosine_margin, 2.0f);
        const float weight = s.power / std::max(distance2, sqr(s.radius));
        table.probability[table.count++] = weight;
        total += weight;
    }
    for (std::size_t i = 0; i < table.count; ++i) table.probability[i] /= total;
    return table;
}

ConeSample sample(const BrightCones::Table& table, Point2 u) {
    RELUMINE_ASSERT(table.count > 0);
    std::size_t i = 0;
    while (i + 1 < table.count && u.x >= table.probability[i]) u.x -= table.probability[i++];
    const float x = std::clamp(u.x / table.probability[i], 0.0f, 0x1.fffffep-1f);
    const float height = table.one_less_cosine[i] * u.y,
                sine = std::sqrt(std::max(0.0f, height * (2 - height)));
    const auto [s, c] = sine_cosine_of_turns(x);
    const WorldDir direction = frame_around(table.axis[i]).to_world({{sine * c, sine * s, 1 - height}});
    return {direction, pdf(table, direction)};
}

float pdf(const BrightCones::Table& table, WorldDir direction) {
    float sum = 0;
    for (std::size_t i = 0; i < table.count; ++i) {
        // |d − a|² / 2 = 1 − cos, exact for narrow cones.
        const float one_less = 0.5f * length_squared(direction.v - table.axis[i]);
        if (one_less <= table.one_less_cosine[i] * (1 + cosine_margin))
            sum += table.probability[i] * cone_pdf(table.one_less_cosine[i]);
    }
    return sum;
}

}  // namespace relumine
