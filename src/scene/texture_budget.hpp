// SPDX-License-Identifier: Apache-2.0
// Keeps the textures of a scene within a number of bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "image/byte_image.hpp"

namespace relumine {

/// Half the width and the height, rounded up; each texel the mean of up to four, in the numbers as encoded.
[[nodiscard]] ByteImage halved(const ByteImage& image);

/// Halves the largest textures as often as needed: all of them end with the greatest limit on their longer
/// side, a power of two, with which they fit together. That does not depend on the order in which they come.
class TextureBudget {
  public:
    explicit TextureBudget(std::uint64_t limit_bytes) : limit_(limit_bytes) {}  // 0: none

    /// `images[i]` is new, those that follow may still be empty; halves what has to be. Throws SceneError
    /// where even single texels do not fit.
    void add(std::vector<ByteImage>& images, std::size_t i);

    /// What was done; "" where all fit.
    [[nodiscard]] std::string warning() const;

  private:
    void lower_limit(std::vector<ByteImage>& images);

    std::uint64_t limit_, bytes_ = 0;
    int longest_side_ = max_image_side;
    bool has_halved_ = false;
};

}  // namespace relumine
