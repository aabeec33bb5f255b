// SPDX-License-Identifier: Apache-2.0
// The one virtual boundary: a method of computing tiles.
#pragma once

#include <functional>

#include "base/tile.hpp"
#include "base/work_done.hpp"
#include "integrators/view.hpp"

namespace relumine {

/// What is done before the tiles of a pass.
struct Preparation {
    std::uint32_t first_sample = 0, sample_count = 1;
    int threads = 1;
    std::function<bool()> stop;  // asked often; true: come to an end soon
    RayCounts rays;              // of the preparation
    CacheCounts counts;
    WorkDone dropped = {};  // of this only what concerns samples that were not finite
    std::function<void(double)> progress =
        {};                        // hears what share is done, between parallel loops; may be empty
    SampleProbe* probe = nullptr;  // for methods that add samples here; may be null
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

    /// Whether prepare() does all the work and tiles only copy what it has found.
    [[nodiscard]] virtual bool works_in_preparation() const { return false; }

    /// Bytes that it will hold beside the scene, as far as that is known before; what grows with what is
    /// found is not.
    [[nodiscard]] virtual std::uint64_t known_bytes() const { return 0; }
    /// Called at most once, before anything is prepared: what grows beyond known_bytes() is to be kept within
    /// so many bytes, whatever the number of threads. Methods that cannot are watched.
    virtual void keep_within(std::uint64_t bytes) { (void)bytes; }

    /// Called once, instead of the passes before, where a render goes on from a later one: brings back what
    /// they have left for it.
    virtual void recover(Preparation& p) { (void)p; }

    /// Called before the tiles of each pass are rendered, by one thread; may use p.threads itself.
    virtual void prepare(Preparation& p) { (void)p; }

    /// Adds the camera samples that `tile` names.
    virtual void render(Tile& tile) const = 0;
};

}  // namespace relumine
