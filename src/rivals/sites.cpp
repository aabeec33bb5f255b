// SPDX-License-Identifier: Apache-2.0
// Sites: radii, and errors of using them.
#include "rivals/sites.hpp"

#include "base/executor.hpp"
#include "cache/lookup.hpp"

namespace relumine {

SiteRadius site_radius(float harmonic_distance, float change_length, float footprint, float accuracy) {
    const float least = least_reach * footprint / accuracy, most = most_reach * footprint / accuracy;
    const float wanted = std::min(harmonic_distance, change_length);
    const float scale = wanted < least ? wanted / least : 1.0f;
    return {std::clamp(wanted, least, most), least, scale};
}

float use_error(const Site& site, Vec3 position, Vec3 normal) {
    const Vec3 offset = position - site.position;
    if (is_behind(offset, site.normal, normal)) return infinity;
    return length(offset) / site.radius + std::sqrt(std::max(0.0f, 1 - dot(site.normal, normal)));
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
    for (std::size_t i = old; i < sites_.size(); ++i)
        spheres_.add(static_cast<std::uint32_t>(i), sites_[i].position, accuracy_ * sites_[i].radius);
}

void Sites::find(Vec3 position, Vec3 normal, std::vector<FoundSite>& found) const {
    found.clear();
    spheres_.for_each_near(position, [&](std::uint32_t id) {
        const float error = use_error(sites_[id], position, normal);
        if (error < accuracy_) found.push_back({id, use_weight(error, accuracy_)});
    });
}

bool Sites::covers(Vec3 position, Vec3 normal, float share) const {
    bool covered = false;
    spheres_.for_each_near(position, [&](std::uint32_t id) {
        covered = covered || use_error(sites_[id], position, normal) < share * accuracy_;
    });
    return covered;
}

}  // namespace relumine
