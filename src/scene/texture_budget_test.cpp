// SPDX-License-Identifier: Apache-2.0
// Textures within a budget: what is halved, to what, and that the order does not matter.
#include "scene/texture_budget.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/scene_data.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

ByteImage image8(int width, int height) {
    ByteImage image{width, height, {}, {}};
    image.rgba8.resize(static_cast<std::size_t>(4 * width * height));
    for (std::size_t i = 0; i < image.rgba8.size(); ++i)
        image.rgba8[i] = static_cast<std::uint8_t>(i * 37 % 251);
    return image;
}

/// All of them under the limit, coming in this order.
std::vector<ByteImage> fitted(const std::vector<ByteImage>& images, std::uint64_t limit,
                              const std::vector<std::size_t>& order) {
    TextureBudget budget(limit);
    std::vector<ByteImage> result(images.size());
    for (const std::size_t i : order) {
        result[i] = images[i];
        budget.add(result, i);
    }
    return result;
}

TEST(LoadSceneTextures, HalvingTakesMeans) {
    const ByteImage image{3, 1, {0, 10, 20, 255, 2, 13, 21, 255, 100, 100, 100, 0}, {}};
    const ByteImage half = halved(image);
    EXPECT_EQ(half.width, 2);
    EXPECT_EQ(half.height, 1);
    EXPECT_EQ(half.rgba8, (std::vector<std::uint8_t>{1, 12, 21, 255, 100, 100, 100, 0}));
    const ByteImage deep{2, 2, {}, {0, 0, 0, 65535, 1000, 0, 0, 65535, 0, 8, 0, 65535, 0, 0, 65535, 65535}};
    EXPECT_EQ(halved(deep).rgba16, (std::vector<std::uint16_t>{250, 2, 16384, 65535}));
}

TEST(LoadSceneTextures, TheLargestGiveWayInWhateverOrderTheyCome) {
    const std::vector<ByteImage> images{image8(64, 32), image8(5, 7), image8(16, 16), image8(33, 1)};
    std::vector<std::size_t> order(images.size());
    std::iota(order.begin(), order.end(), 0u);
    const std::vector<ByteImage> expected = fitted(images, 2300, order);  // 64 × 32 texels alone are 8192
    EXPECT_EQ(expected[0].width, 16);
    EXPECT_EQ(expected[1].width, 5);
    EXPECT_EQ(expected[2].width, 16);
    EXPECT_EQ(expected[3].width, 9);
    while (std::ranges::next_permutation(order).found) {
        const std::vector<ByteImage> other = fitted(images, 2300, order);
        for (std::size_t i = 0; i < images.size(); ++i) EXPECT_EQ(other[i].rgba8, expected[i].rgba8) << i;
    }
}

TEST(LoadSceneTextures, WhatFitsIsLeftAlone) {
    const std::vector<ByteImage> images{image8(64, 32), image8(5, 7)};
    for (const std::uint64_t limit : {std::uint64_t{0}, std::uint64_t{8192 + 140}})
        EXPECT_EQ(fitted(images, limit, {0, 1})[0].rgba8, images[0].rgba8);
    EXPECT_EQ(fitted(images, 8192 + 139, {0, 1})[0].width, 32);
}

TEST(LoadSceneTextures, FewerBytesThanTexturesAreRefused) {
    EXPECT_THROW((void)fitted({image8(8, 8), image8(8, 8)}, 7, {0, 1}), SceneError);
    EXPECT_EQ(fitted({image8(8, 8), image8(8, 8)}, 8, {0, 1})[1].rgba8.size(), 4u);
}

TEST(LoadSceneTextures, ScenesSayWhatWasHalved) {
    const test::TempFolder folder;
    const std::vector<std::uint8_t> rgb(3 * 32 * 32, 200);
    const std::vector<std::uint8_t> png = encode_png(32, 32, rgb);
    (void)folder.write("a.png", {reinterpret_cast<const char*>(png.data()), png.size()});
    test::GltfBuilder builder = test::triangle_document();
    builder.add("images", {{"uri", "a.png"}});
    builder.add("textures", {{"source", 0}});
    builder.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
    builder.primitive()["material"] = 0;
    builder.attributes()["TEXCOORD_0"] = builder.add_vec2({0, 0, 1, 0, 0, 1});
    const std::vector<std::string> scenes{
        folder.write("a.gltf", builder.json_text()),
        folder.write("a.pbrt",
                     "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n"
                     "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n")};
    for (const std::string& path : scenes) {
        SceneOptions options;
        EXPECT_EQ(load_scene(path, options).data().images.at(0).width, 32) << path;
        options.texture_limit = 1100;
        const Scene scene = load_scene(path, options);
        EXPECT_EQ(scene.data().images.at(0).width, 16) << path;
        EXPECT_TRUE(std::ranges::any_of(scene.info().warnings, [](const std::string& warning) {
            return warning.starts_with("texture limit of 1100 bytes");
        })) << path;
    }
}

}  // namespace
}  // namespace relumine
