// SPDX-License-Identifier: Apache-2.0
// Sites: radii and the grid.
#include "rivals/sites.hpp"

#include "base/executor.hpp"
#include "base/hash.hpp"

namespace relumine {
namespace {

/// How far behind a record's surface a point may lie, of its distance: curved surfaces are no planes.
constexpr float greatest_step = 0.1f;

struct CellIndex {
    std::int64_t x, y, z;
};

CellIndex cell_at(Vec3 p, int level) {
    const auto along = [&](float c) { return static_cast<std::int64_t>(std::floor(std::ldexp(c, -level))); };
    return {along(p.x), along(p.y), along(p.z)};
}

/// Cells of different places may share a key: their sites are then looked at in vain.
std::uint64_t key_of(const CellIndex& cell, int level) {
    return hash(static_cast<std::uint64_t>(level + 1024), static_cast<std::uint64_t>(cell.x), cell.y, cell.z);
}

/// The least level whose cells are as wide as the sphere of this radius.
int level_of(float radius) {
    int level = 0;
    std::frexp(2 * radius, &level);
    return level;
}

}  // namespace

SiteRadius site_radius(float harmonic_distance, float change_length, float footprint, float accuracy) {
    const float least = least_reach * footprint / accuracy, most = most_reach * footprint / accuracy;
    const float wanted = std::min(harmonic_distance, change_length);
    const float scale = wanted < least ? wanted / least : 1.0f;
    return {std::clamp(wanted, least, most), least, scale};
}

float use_error(const Site& site, Vec3 position, Vec3 normal) {
    const Vec3 offset = position - site.position;
    const float distance = length(offset);
    if (0.5f * dot(offset, site.normal + normal) < -greatest_step * distance) return infinity;
    return distance / site.radius + std::sqrt(std::max(0.0f, 1 - dot(site.normal, normal)));
}

float use_weight(float error, float accuracy) {
    constexpr float nearest = 1e-3f;  // closer ones count no more
    return 1 / std::max(error, nearest * accuracy) - 1 / accuracy;
}

/// One step is enough: ways are no shorter by a third site, so the least of all neighbours' unclamped radii
/// and ways holds for the clamped ones, too.
void Sites::add(const std::vector<Site>& more, int threads) {
    const std::size_t old = sites_.size();
    sites_.insert(sites_.end(), more.begin(), more.end());
    for (const Site& site : more) unclamped_.push_back(site.radius);
    constexpr std::size_t chunk = 64;
    parallel_for(threads, (sites_.size() + chunk - 1) / chunk, [&](std::size_t part) {
        for (std::size_t i = part * chunk; i < std::min(sites_.size(), (part + 1) * chunk); ++i) {
            Site& site = sites_[i];
            for (std::size_t j = i < old ? old : 0; j < sites_.size(); ++j)
                if (unclamped_[j] < site.radius)
                    site.radius =
                        std::min(site.radius, unclamped_[j] + length(sites_[j].position - site.position));
            site.radius = std::max(site.radius, site.least);
        }
    });
    for (std::size_t i = old; i < sites_.size(); ++i) put(static_cast<std::uint32_t>(i));
}

void Sites::put(std::uint32_t id) {
    const float reach = accuracy_ * sites_[id].radius;
    const int level = level_of(reach);
    const auto place = std::lower_bound(levels_.begin(), levels_.end(), level);
    if (place == levels_.end() || *place != level) levels_.insert(place, level);
    const Vec3 p = sites_[id].position, half{reach, reach, reach};
    const CellIndex first = cell_at(p - half, level), last = cell_at(p + half, level);
    for (std::int64_t z = first.z; z <= last.z; ++z)
        for (std::int64_t y = first.y; y <= last.y; ++y)
            for (std::int64_t x = first.x; x <= last.x; ++x) cells_[key_of({x, y, z}, level)].push_back(id);
}

template <typename Use>
void Sites::for_each_near(Vec3 position, const Use& use) const {
    for (const int level : levels_) {
        const auto cell = cells_.find(key_of(cell_at(position, level), level));
        if (cell == cells_.end()) continue;
        for (const std::uint32_t id : cell->second) use(id);
    }
}

void Sites::find(Vec3 position, Vec3 normal, std::vector<FoundSite>& found) const {
    found.clear();
    for_each_near(position, [&](std::uint32_t id) {
        const float error = use_error(sites_[id], position, normal);
        if (error < accuracy_) found.push_back({id, use_weight(error, accuracy_)});
    });
}

bool Sites::covers(Vec3 position, Vec3 normal, float share) const {
    bool covered = false;
    for_each_near(position, [&](std::uint32_t id) {
        covered = covered || use_error(sites_[id], position, normal) < share * accuracy_;
    });
    return covered;
}

}  // namespace relumine
