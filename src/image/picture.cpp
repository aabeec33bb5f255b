// SPDX-License-Identifier: Apache-2.0
// Image: finding layers and pixels.
#include "image/picture.hpp"

#include <algorithm>

#include "base/assert.hpp"

namespace relumine {

const Layer* Image::layer(const std::string& name) const {
    const auto found = std::ranges::find(layers, name, &Layer::name);
    return found == layers.end() ? nullptr : &*found;
}

std::array<float, 3> Image::rgb(int x, int y) const {
    const Layer* picture = layer();
    RELUMINE_ASSERT(picture && x >= 0 && x < width && y >= 0 && y < height);
    const std::size_t channels = picture->channels.size();
    const std::size_t index =
        static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    const float* pixel = picture->pixels.data() + index * channels;
    if (channels < 3) return {pixel[0], pixel[0], pixel[0]};  // grey, perhaps with alpha
    return {pixel[0], pixel[1], pixel[2]};
}

Image make_picture(int width, int height, std::vector<std::string> channels, std::vector<float> pixels) {
    const auto values = static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * channels.size();
    RELUMINE_ASSERT(width > 0 && height > 0 && pixels.size() == values);
    Image image{width, height, {0, 0, width, height}, width, height, {}, {}};
    image.layers.push_back({"", std::move(channels), std::move(pixels)});
    return image;
}

}  // namespace relumine
