// SPDX-License-Identifier: Apache-2.0
// A record: what the rays of a group of camera samples have met, as points of the world that maps of other
// groups may be filled with as well.
#pragma once

#include <span>
#include <vector>

#include "blocks/direction_grid.hpp"
#include "cache/hemisphere_samples.hpp"

namespace relumine {

/// The texels that a ray stands for, a run of the grid, and the one that it goes through.
struct TexelRun {
    std::uint16_t first = 0, count = 0, through = 0;
};

/// A ray that has met a surface.
struct SeenRadiance {
    Spectrum direct, indirect;  // W·sr⁻¹·m⁻², from lights and reflected; what is bright is not in it
    Vec3 normal;                // geometric, unit, on the ray's side
    float distance = 0;         // metres, from where the ray starts
    TexelRun run;
};

/// A ray that has met nothing but panes.
struct OpenDirection {
    Spectrum tint{1};  // of the panes
    TexelRun run;
};

struct MapRecord {
    GatherPoint anchor;                // where most rays start
    float footprint = 0;               // metres that a pixel covers there
    float center_x = 0, center_y = 0;  // pixels: the block's middle
    float size = 0;                    // pixels: the block's side
    bool has_map = true;               // false: its block is divided, but what its rays have met counts
    std::vector<float> x, y, z;        // metres, world space: where `seen` is; padded to whole packets
    std::vector<SeenRadiance> seen;
    std::vector<OpenDirection> open;

    void clear_rays();
    void add(const SeenRadiance& ray, Vec3 position);
    /// After the last ray.
    void pad();
    /// Memory that the record occupies.
    [[nodiscard]] std::size_t bytes() const;
};

}  // namespace relumine
