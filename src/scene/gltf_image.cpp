// SPDX-License-Identifier: Apache-2.0
// Images of a glTF file, decoded.
#include "scene/gltf_image.hpp"

#include <fmt/format.h>

#include <atomic>
#include <mutex>

#include "base/executor.hpp"
#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr std::size_t max_pixels_in_all = std::size_t{1} << 31;  // 8 GiB of 8-bit RGBA

ByteImage decode(const GltfFile& file, int i) {
    const auto& image = file.model.images[to_size(i)];
    const std::string name = image.name.empty() ? "" : ' ' + quote(image.name);
    const std::string where = file.where(fmt::format("images[{}]{}", i, name));
    if (image.uri.empty()) return decode_byte_image(view_bytes(file, image.bufferView), where);
    return decode_byte_image(file.files->read_uri(image.uri, where), where);
}

}  // namespace

std::vector<ByteImage> decode_gltf_images(const GltfFile& file, const std::vector<int>& which,
                                          TextureBudget& budget) {
    std::vector<ByteImage> images(which.size());
    std::atomic<std::size_t> pixels = 0;
    std::mutex mutex;
    parallel_for(resolve_threads(0), which.size(), [&](std::size_t i) {
        if (pixels > max_pixels_in_all) return;
        ByteImage image = decode(file, which[i]);
        pixels += static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
        const std::lock_guard lock(mutex);
        images[i] = std::move(image);
        budget.add(images, i);
    });
    if (pixels > max_pixels_in_all)
        throw SceneError{expected_found(file.where("images"),
                                        fmt::format("at most {} pixels in all", max_pixels_in_all), "more")};
    return images;
}

}  // namespace relumine
