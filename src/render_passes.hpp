// SPDX-License-Identifier: Apache-2.0
// Pass after pass over the tiles, interrupted and resumed without changing a bit.
#pragma once

#include "film/checkpoint.hpp"
#include "integrators/integrator.hpp"
#include "render_keeper.hpp"
#include "render_monitor.hpp"

namespace relumine {

/// What a pass adds to every pixel.
struct Pass {
    std::uint32_t first_sample = 0, sample_count = 0;
};

/// Passes of 1, 1, 2, 4, … samples as the integrator likes them, so that there is soon something to see.
[[nodiscard]] std::vector<Pass> passes_of(std::uint32_t samples, const Integrator& integrator);

/// Fills a film. The order of sums depends on the picture alone: passes in turn, each pixel once in each. So
/// what is kept between tiles (the film, which tiles are done, what was counted) is enough to go on from.
class PassRunner {
  public:
    PassRunner(Integrator& integrator, const PixelRect& window, std::uint32_t samples, int threads,
               Film& film, Monitor& monitor, Keeper& keeper);

    /// Goes on from there. Throws FileError, naming `file`, where the film is of another kind.
    void resume(const Checkpoint& checkpoint, const std::string& file);

    /// False where it was stopped on the way.
    bool run();

  private:
    [[nodiscard]] std::uint64_t work_done() const;  // pixels × samples
    void finish_with_gaps();
    [[nodiscard]] Preparation preparation(const Pass& pass);
    void recover();
    /// False where it was stopped on the way.
    bool run_pass(const Pass& pass);
    bool prepare(const Pass& pass);
    void render_tiles(const Pass& pass, bool even_if_stopped, bool marks);
    void close_pass();
    [[nodiscard]] Checkpoint snapshot();

    Integrator& integrator_;
    PixelRect window_;
    int threads_;
    Film& film_;
    Monitor& monitor_;
    Keeper& keeper_;
    std::vector<PixelRect> tiles_;
    std::vector<Pass> passes_;

    // Of the pass under way; the monitor's lock guards it while tiles are rendered.
    std::vector<std::uint8_t> done_;  // by tile
    bool prepared_ = false;
    WorkDone before_;  // what was done when it began; counts while it is not prepared
};

}  // namespace relumine
