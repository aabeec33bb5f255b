// SPDX-License-Identifier: Apache-2.0
// EXT_mesh_gpu_instancing: one node in many places.
#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::TempFolder;

json& attributes(GltfBuilder& builder) {
    return builder.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
}

/// The triangle at (1, 0, 0), and at (0, 2, 0) turned by 90° about Z and scaled by 2.
GltfBuilder two_places() {
    GltfBuilder builder = test::triangle_document();
    const float half = 0.70710678f;
    attributes(builder)["TRANSLATION"] = builder.add_vec3({1, 0, 0, 0, 2, 0});
    attributes(builder)["ROTATION"] = builder.add_vec4({0, 0, 0, 1, 0, 0, half, half});
    attributes(builder)["SCALE"] = builder.add_vec3({1, 1, 1, 2, 2, 2});
    return builder;
}

SceneData read(const GltfBuilder& builder) {
    const TempFolder folder;
    return read_gltf(folder.write("scene.gltf", builder.json_text()));
}

TEST(GltfInstancing, PlacesTheMeshUnderItsNode) {
    GltfBuilder builder = two_places();
    builder.document["nodes"][0]["translation"] = {0, 0, 5};
    const SceneData scene = read(builder);
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    const Vec3 first = scene.instances[0].world_from_object.point({1, 0, 0}),
               second = scene.instances[1].world_from_object.point({1, 0, 0});
    EXPECT_NEAR(first.x, 2, 1e-6);
    EXPECT_NEAR(first.z, 5, 1e-6);
    EXPECT_NEAR(second.x, 0, 1e-6);
    EXPECT_NEAR(second.y, 4, 1e-6);
    EXPECT_NEAR(second.z, 5, 1e-6);
}

TEST(GltfInstancing, QuaternionsMayBeNormalisedBytes) {
    GltfBuilder builder = test::triangle_document();
    const std::size_t turned =
        builder.add_accessor(std::vector<std::int8_t>{0, 0, 90, 90}, 5120, "VEC4", 4);  // length 1.002
    builder.document["accessors"][turned]["normalized"] = true;
    attributes(builder)["ROTATION"] = turned;
    const SceneData scene = read(builder);
    ASSERT_EQ(scene.instances.size(), 1u);
    EXPECT_NEAR(scene.instances[0].world_from_object.point({1, 0, 0}).y, 1, 1e-6);
}

TEST(GltfInstancing, DamageEndsInOneClearLine) {
    const auto message = [](const GltfBuilder& builder) {
        try {
            (void)read(builder);
        } catch (const Error& error) {
            return std::string{error.what()};
        }
        return std::string{};
    };
    const auto expect = [&](const GltfBuilder& builder, const char* text) {
        const std::string found = message(builder);
        EXPECT_NE(found.find(text), found.npos) << found;
    };
    GltfBuilder builder = two_places();
    attributes(builder)["SCALE"] = 99;
    expect(builder, "EXT_mesh_gpu_instancing.attributes.\"SCALE\": expected an index");
    builder = two_places();
    builder.document["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"] = json::object();
    expect(builder, "EXT_mesh_gpu_instancing.attributes: expected a value, found nothing");
    builder = two_places();
    attributes(builder)["SCALE"] = builder.add_vec3({1, 1, 1});
    expect(builder, "expected 2 elements, as the others have, found 1");
    builder = two_places();
    attributes(builder)["ROTATION"] = builder.add_vec3({1, 1, 1, 1, 1, 1});
    expect(builder, "expected VEC4, found VEC3");
    builder = two_places();
    attributes(builder)["ROTATION"] = builder.add_vec4({0, 0, 0, 1, 0, 0, 0, 0});
    expect(builder, "ROTATION: element 1: expected a unit quaternion");
    builder = test::triangle_document();
    attributes(builder)["TRANSLATION"] =
        builder.add("accessors", {{"componentType", 5126}, {"count", 2000000000}, {"type", "VEC3"}});
    expect(builder, "TRANSLATION: expected an accessor with a bufferView, found none");
    builder = two_places();
    builder.document["accessors"][attributes(builder)["TRANSLATION"].get<std::size_t>()]["count"] =
        2000000000;
    expect(builder, "expected at most 8388608 places in all");
}

}  // namespace
}  // namespace relumine
