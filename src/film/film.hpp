// SPDX-License-Identifier: Apache-2.0
// Collects tiles, pass after pass, and develops the image.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/tile.hpp"
#include "relumine/image.hpp"

namespace relumine {

/// The layers that a film can keep beside the picture itself.
[[nodiscard]] std::vector<std::string> film_layer_names();

/// Whether any of these layers needs FirstSurface.
[[nodiscard]] bool needs_surfaces(const std::vector<std::string>& layers);

/// What a film holds, to the bit. Of the pass under way only finished tiles; empty where there is none.
struct FilmState {
    std::uint32_t passes = 0;              // finished
    std::vector<float> finished, pending;  // sums
    std::vector<std::uint32_t> finished_samples, pending_samples;
};

/// Bytes that a film of so many pixels takes, and the picture that it develops.
struct FilmBytes {
    std::uint64_t film = 0, picture = 0;
};
[[nodiscard]] FilmBytes film_bytes(std::uint64_t pixels, const std::vector<std::string>& layers);

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

    /// How many passes are finished.
    [[nodiscard]] std::uint32_t passes() const { return passes_; }

    /// What must be kept to go on later: all but those tiles of the pass under way that are not in `done`.
    /// Other tiles may be added meanwhile.
    [[nodiscard]] FilmState state(std::span<const PixelRect> done) const;
    /// Goes on from there. False, and nothing has happened, where it is the state of another kind of film.
    [[nodiscard]] bool restore(const FilmState& state);

    /// Camera samples in the finished passes, all pixels together.
    [[nodiscard]] std::uint64_t samples() const;

    /// Means over the samples of the finished passes. Pixels without samples are black.
    [[nodiscard]] Image develop() const;

  private:
    struct LayerSpec;
    friend FilmBytes film_bytes(std::uint64_t pixels, const std::vector<std::string>& layers);
    /// Kept, and shown in the picture.
    [[nodiscard]] static std::pair<std::size_t, std::size_t> floats_per_pixel(
        const std::vector<std::string>& layers);
    [[nodiscard]] static const std::vector<LayerSpec>& known_layers();
    [[nodiscard]] std::size_t offset(int x, int y) const;

    int frame_width_, frame_height_;
    PixelRect window_;
    std::vector<const LayerSpec*> layers_;
    std::size_t channels_ = 0;               // of all layers together
    std::vector<float> finished_, pending_;  // pixels × channels_, sums
    std::vector<std::uint32_t> finished_samples_, pending_samples_;
    std::uint32_t passes_ = 0;
};

}  // namespace relumine
