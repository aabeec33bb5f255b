// SPDX-License-Identifier: Apache-2.0
// Textures within a number of bytes.
#include "scene/texture_budget.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

std::uint64_t bytes_of(const ByteImage& image) {
    return image.rgba8.size() + image.rgba16.size() * sizeof(std::uint16_t);
}

/// `from` has 4 × width × height channels.
template <typename Channel>
std::vector<Channel> halved_channels(const std::vector<Channel>& from, std::size_t width,
                                     std::size_t height) {
    std::vector<Channel> to;
    to.reserve(4 * ((width + 1) / 2) * ((height + 1) / 2));
    for (std::size_t y = 0; y < height; y += 2) {
        const std::size_t below = std::min(y + 1, height - 1);
        for (std::size_t x = 0; x < width; x += 2) {
            const std::size_t beside = std::min(x + 1, width - 1);
            for (std::size_t c = 0; c < 4; ++c) {
                const auto at = [&](std::size_t u, std::size_t v) {
                    return std::uint32_t{from[4 * (v * width + u) + c]};
                };
                const std::uint32_t sum = at(x, y) + at(beside, y) + at(x, below) + at(beside, below);
                to.push_back(static_cast<Channel>((sum + 2) / 4));
            }
        }
    }
    return to;
}

}  // namespace

ByteImage halved(const ByteImage& image) {
    const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
    return {
        (image.width + 1) / 2, (image.height + 1) / 2,
        image.rgba8.empty() ? std::vector<std::uint8_t>{} : halved_channels(image.rgba8, width, height),
        image.rgba16.empty() ? std::vector<std::uint16_t>{} : halved_channels(image.rgba16, width, height)};
}

void TextureBudget::add(std::vector<ByteImage>& images, std::size_t i) {
    if (limit_ == 0) return;
    while (std::max(images[i].width, images[i].height) > longest_side_) images[i] = halved(images[i]);
    bytes_ += bytes_of(images[i]);
    while (bytes_ > limit_) lower_limit(images);
}

void TextureBudget::lower_limit(std::vector<ByteImage>& images) {
    if (longest_side_ == 1)
        throw SceneError{expected_found(
            "texture limit",
            fmt::format("at least {} bytes for {} textures of one texel", bytes_, images.size()),
            fmt::format("{}", limit_))};
    longest_side_ /= 2;
    has_halved_ = true;
    bytes_ = 0;
    for (ByteImage& image : images) {
        while (std::max(image.width, image.height) > longest_side_) image = halved(image);
        bytes_ += bytes_of(image);
    }
}

std::string TextureBudget::warning() const {
    if (!has_halved_) return "";
    return fmt::format(
        "texture limit of {} bytes: textures were halved until no side was longer than {} texels", limit_,
        longest_side_);
}

}  // namespace relumine
