// SPDX-License-Identifier: Apache-2.0
// Collects tiles, pass after pass, and develops the image.
#pragma once

#include <string>
#include <vector>

#include "base/tile.hpp"
#include "relumine/image.hpp"

namespace relumine {

/// The layers that a film can keep beside the picture itself.
[[nodiscard]] std::vector<std::string> film_layer_names();

/// Whether any of these layers needs FirstSurface.
[[nodiscard]] bool needs_surfaces(const std::vector<std::string>& layers);

/// The sums of the finished passes and of the one under way. Tiles of a pass may come in any order and from
/// any thread as long as they do not overlap; a pixel's sums are added in the order of the passes, so the
/// result does not depend on threads.
class Film {
  public:
    /// `layers` are among film_layer_names().
    Film(int frame_width, int frame_height, const PixelRect& window, const std::vector<std::string>& layers);

    /// Stores a tile of the pass under way.
    void add(const Tile& tile);
    /// Adds the pass under way to the finished ones.
    void finish_pass();
    /// Whether any pass is finished.
    [[nodiscard]] bool has_passes() const { return passes_ > 0; }

    /// Camera samples in the finished passes, all pixels together.
    [[nodiscard]] std::uint64_t samples() const;

    /// Means over the samples of the finished passes. Pixels without samples are black.
    [[nodiscard]] Image develop() const;

  private:
    struct LayerSpec;
    [[nodiscard]] static const std::vector<LayerSpec>& known_layers();
    [[nodiscard]] std::size_t offset(int x, int y) const;

    int frame_width_, frame_height_;
    PixelRect window_;
    std::vector<const LayerSpec*> layers_;
    std::size_t channels_ = 0;               // of all layers together
    std::vector<float> finished_, pending_;  // pixels × channels_, sums
    std::vector<std::uint32_t> finished_samples_, pending_samples_;
    int passes_ = 0;
};

}  // namespace relumine
