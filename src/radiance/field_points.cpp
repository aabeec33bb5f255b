// SPDX-License-Identifier: Apache-2.0
// Points on elements: those that rays have met, and those that are looked for.
#include "radiance/field_points.hpp"

#include "base/hash.hpp"
#include "base/sample_stream.hpp"
#include "shading/surface_point.hpp"

namespace relumine {
namespace {

/// Height over the surface of rays that explore it, of the cell's size.
constexpr float lift = 0.05f;

/// With so many points no others are looked for.
constexpr std::size_t enough = 8;

/// Where straight down from `above` (not farther than `depth`) the element's surface lies.
std::optional<SurfacePoint> project(const Transport& t, const FieldElement& e, Vec3 above, float depth,
                                    RayCounts& rays) {
    constexpr float least_cosine = 0.9f;
    rays.add(RayPurpose::field);
    const Ray down{above, {-e.normal}, depth, 0};
    const Hit hit = t.tracer.closest_hit(down);
    if (!hit) return {};
    SurfacePoint p = surface_point(t.scene, hit, {e.normal});
    if (dot(p.geometric_normal, e.normal) < least_cosine) return {};
    return p;
}

bool sees(const Transport& t, Vec3 from, Vec3 to, RayCounts& rays) {
    const Vec3 way = to - from;
    const float distance = length(way);
    if (!(distance > 0)) return true;
    rays.add(RayPurpose::field);
    return !t.tracer.occluded({from, {way / distance}, distance, 0});
}

/// The point of the element's surface that lies below or above `target` along its normal, if it is in the
/// cell and can be seen from the element.
std::optional<SurfacePoint> surface_near(const Transport& t, const FieldCells& cells, const FieldElement& e,
                                         Vec3 target, RayCounts& rays) {
    const Vec3 up = e.normal * (lift * e.size + e.offset);
    const Vec3 across = target - e.position - e.normal * dot(target - e.position, e.normal);
    if (!sees(t, e.position + up, e.position + across + up, rays)) return {};
    auto p = project(t, e, e.position + across + up, 4 * lift * e.size + 2 * e.offset, rays);
    if (!p || !cells.in_cell_of(e, p->position)) return {};
    return p;
}

/// Adds points spread over what an element's cell holds of its surface, as far as the element sees them,
/// until there are enough.
void explore(const Transport& t, const FieldCells& cells, ElementId id, std::uint64_t seed,
             std::vector<StartPoint>& points, RayCounts& rays) {
    const std::uint32_t tries = cells.elements()[id].coarse ? 32 : 16;
    constexpr float reach = 1.42f;  // of a square that contains the cell's section with any plane
    const FieldElement& e = cells.elements()[id];
    const Frame frame = frame_around(e.normal);
    const Vec3 middle = cells.middle_of(e);
    for (std::uint32_t i = 0; i < tries && points.size() < enough; ++i) {
        const Point2 u =
            SampleStream{hash(seed, id, 0x706f696e7473), i, tries, PointSet::sobol}.next2(Dim::pixel);
        const Vec3 target = middle + (frame.s * (u.x - 0.5f) + frame.t * (u.y - 0.5f)) * (reach * e.size);
        if (const auto p = surface_near(t, cells, e, target, rays))
            points.push_back({p->position, p->geometric_normal, p->offset});
    }
}

}  // namespace

void PointReservoirs::offer(ElementId id, const StartPoint& point) {
    if (id >= reservoirs_.size()) reservoirs_.resize(id + 1);
    Reservoir& r = reservoirs_[id];
    const std::uint32_t n = r.offered++;
    if (r.points.size() < most) {
        r.points.push_back(point);
        return;
    }
    // Every point that is offered stays with the same probability.
    const std::uint64_t place = hash(id, n, 0x7265736572766f69) % (n + 1);
    if (place < most) r.points[place] = point;
}

void PointReservoirs::set(ElementId id, std::vector<StartPoint> points) {
    if (id >= reservoirs_.size()) reservoirs_.resize(id + 1);
    reservoirs_[id].points = std::move(points);
}

std::span<const StartPoint> PointReservoirs::of(ElementId id) const {
    return id < reservoirs_.size() ? std::span<const StartPoint>(reservoirs_[id].points)
                                   : std::span<const StartPoint>();
}

void center(const Transport& t, const FieldCells& cells, FieldElement& e, RayCounts& rays) {
    const Vec3 middle = cells.middle_of(e);
    for (const float part : {1.0f, 0.6f, 0.3f}) {
        const auto p = surface_near(t, cells, e, lerp(e.position, middle, part), rays);
        if (!p) continue;
        e.position = p->position;
        e.offset = p->offset;
        return;
    }
}

std::vector<StartPoint> start_points(const Transport& t, const FieldCells& cells, ElementId id,
                                     std::span<const StartPoint> met, std::uint64_t seed, RayCounts& rays) {
    std::vector<StartPoint> points(met.begin(), met.end());
    const bool coarse = cells.elements()[id].coarse;
    if (points.empty() || !coarse) explore(t, cells, id, seed, points, rays);
    if (points.empty()) {
        const FieldElement& e = cells.elements()[id];
        points.push_back({e.position, e.normal, e.offset});
    }
    return points;
}

}  // namespace relumine
