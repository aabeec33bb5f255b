// SPDX-License-Identifier: Apache-2.0
// The one virtual boundary: a method of computing tiles.
#pragma once

#include <functional>

#include "base/tile.hpp"
#include "integrators/view.hpp"

namespace relumine {

/// What is done before the tiles of a pass.
struct Preparation {
    std::uint32_t first_sample = 0, sample_count = 1;
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon
    RayCounts rays;              // of the preparation
    CacheCounts counts;
};

/// A method. Tiles are independent; any number of threads may ask at a time.
class Integrator {
  public:
    virtual ~Integrator() = default;

    /// Pixels along each side of tiles; a multiple of 4.
    [[nodiscard]] virtual int tile_side() const { return 16; }
    /// The fewest samples per pixel that are worth a pass, and the most that one may have.
    [[nodiscard]] virtual std::uint32_t shortest_pass() const { return 1; }
    [[nodiscard]] virtual std::uint32_t longest_pass() const { return 64; }

    /// Called before the tiles of each pass are rendered, by one thread; may use p.threads itself.
    virtual void prepare(Preparation& p) { (void)p; }

    /// Adds the camera samples that `tile` names.
    virtual void render(Tile& tile) const = 0;
};

}  // namespace relumine
