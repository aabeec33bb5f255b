// SPDX-License-Identifier: Apache-2.0
// Where records are and how far they may be used [Ward88], with radii that neighbours clamp [Krivanek06].
#pragma once

#include <cstdint>
#include <vector>

#include "cache/sphere_index.hpp"

namespace relumine {

/// A record's place and reach. It may be used as far as accuracy × radius.
struct Site {
    Vec3 position, normal;  // world space
    float radius = 0;       // metres
    float least = 0;        // what clamping leaves at least, metres
};

/// Bounds on how far records are used, pixels: closer ones cost more than they gain, farther ones show.
inline constexpr float least_reach = 1.5f, most_reach = 40;

/// A site's radius: the harmonic mean distance of what is seen, no more than the length within which the
/// light changes, within bounds relative to a pixel's `footprint`, so that it is used `accuracy` times that
/// far. Also gives what the gradients must be multiplied by where the lower bound is more than the radius
/// [Krivanek09].
struct SiteRadius {
    float radius, least, gradient_scale;
};
[[nodiscard]] SiteRadius site_radius(float harmonic_distance, float change_length, float footprint,
                                     float accuracy);

/// The error that using a record at a point makes [Ward88]; infinite where the point lies behind what
/// the record has seen.
[[nodiscard]] float use_error(const Site& site, Vec3 position, Vec3 normal);

/// How much a record counts whose error is less than `accuracy`: 0 where it is as much, so that none is seen
/// to begin [Krivanek09].
[[nodiscard]] float use_weight(float error, float accuracy);

struct FoundSite {
    std::uint32_t id;
    float weight;
};

/// Sites by the spheres in which they are used. Adding is for one thread; any number may look up at a time.
class Sites {
  public:
    explicit Sites(float accuracy) : accuracy_(accuracy) {}

    [[nodiscard]] float accuracy() const { return accuracy_; }
    [[nodiscard]] std::size_t size() const { return sites_.size(); }
    [[nodiscard]] const Site& operator[](std::size_t id) const { return sites_[id]; }

    /// Adds sites and clamps the radii of all: none is longer than a neighbour's and the way to it together,
    /// unless its `least` is.
    void add(const std::vector<Site>& more, int threads);

    /// All that may be used at a point, in an order that only depends on the sites.
    void find(Vec3 position, Vec3 normal, std::vector<FoundSite>& found) const;
    /// Whether any may be used with an error below `share` of the accuracy.
    [[nodiscard]] bool covers(Vec3 position, Vec3 normal, float share) const;

  private:
    float accuracy_;
    std::vector<Site> sites_;
    std::vector<float> unclamped_;  // radius of each
    SphereIndex spheres_;           // that use them, by index of sites_
};

}  // namespace relumine
