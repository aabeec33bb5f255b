// SPDX-License-Identifier: Apache-2.0
// Fingerprints of scenes: what changes a picture changes the part that it belongs to, and no other.
#include "scene/scene_fingerprint.hpp"

#include <gtest/gtest.h>

#include <functional>

namespace relumine {
namespace {

SceneData small_scene() {
    SceneData scene;
    scene.meshes.resize(1);
    scene.meshes[0].positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.meshes[0].triangles = {{{0, 1, 2}}};
    scene.materials.resize(1);
    scene.materials[0].base_color_texture = TextureRef{};
    scene.instances.resize(1);
    scene.images = {{1, 1, {255, 255, 255, 255}, {}}};
    scene.point_lights = {{{0, 0, 1}, Spectrum{1}}};
    scene.environment = Environment{1, 1, {Spectrum{1}}, 0};
    scene.cameras.resize(1);
    scene.cameras[0].name = "main";
    return scene;
}

/// The parts whose hashes differ.
std::vector<std::string> differences(const SceneData& a, const SceneData& b) {
    const auto first = scene_fingerprint(a), second = scene_fingerprint(b);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < first.size(); ++i)
        if (first[i].second != second[i].second) names.push_back(first[i].first);
    return names;
}

TEST(SceneFingerprint, NamesThePartThatDiffers) {
    struct Change {
        std::string part;
        std::function<void(SceneData&)> apply;
    };
    const std::vector<Change> changes{
        {"geometry", [](SceneData& s) { s.meshes[0].positions[2].y = 1.0000001f; }},
        {"geometry", [](SceneData& s) { s.meshes[0].normals.resize(3); }},
        {"geometry", [](SceneData& s) { s.meshes[0].triangles[0].vertex[0] = 1; }},
        {"geometry", [](SceneData& s) { s.meshes.emplace_back(); }},
        {"geometry",
         [](SceneData& s) { s.meshes[0].projection = std::make_shared<const TextureProjection>(); }},
        {"instances", [](SceneData& s) { s.instances[0].world_from_object.m[0][3] = 1e-9; }},
        {"materials", [](SceneData& s) { s.materials[0].emission.b = 1; }},
        {"materials", [](SceneData& s) { s.materials[0].base_color_texture->wrap_v = Wrap::clamp; }},
        {"materials", [](SceneData& s) { s.materials[0].base_color_texture->turned_away = ImageId{0}; }},
        {"materials", [](SceneData& s) { s.materials[0].attenuation_distance = 3; }},
        {"textures", [](SceneData& s) { s.images[0].rgba8[3] = 254; }},
        {"lights", [](SceneData& s) { s.point_lights[0].intensity.r = 2; }},
        {"lights", [](SceneData& s) { s.spot_lights.emplace_back(); }},
        {"environment", [](SceneData& s) { s.environment->rotation = 1; }},
        {"environment", [](SceneData& s) { s.environment.reset(); }},
        {"cameras", [](SceneData& s) { s.cameras[0].vertical_extent = 0.71; }},
    };
    for (const Change& change : changes) {
        SceneData changed = small_scene();
        change.apply(changed);
        EXPECT_EQ(differences(small_scene(), changed), std::vector<std::string>{change.part});
    }
}

TEST(SceneFingerprint, KnowsHowTexturesAreProjected) {
    const auto projected = [](const TextureProjection& projection) {
        SceneData scene = small_scene();
        scene.meshes[0].projection = std::make_shared<const TextureProjection>(projection);
        return scene;
    };
    using Kind = TextureProjection::Kind;
    const SceneData before = projected({Kind::planar, {}, {0, 0, 1}, false});
    EXPECT_TRUE(differences(before, projected({Kind::planar, {}, {0, 0, 1}, false})).empty());
    Transform moved;
    moved.m[0][3] = 1;
    for (const TextureProjection& other : {TextureProjection{Kind::spherical, {}, {0, 0, 1}, false},
                                           {Kind::planar, moved, {0, 0, 1}, false},
                                           {Kind::planar, {}, {0, 1, 0}, false},
                                           {Kind::planar, {}, {0, 0, 1}, true}})
        EXPECT_EQ(differences(before, projected(other)), std::vector<std::string>{"geometry"});
}

TEST(SceneFingerprint, WhereTheSceneCameFromDoesNotCount) {
    SceneData moved = small_scene();
    moved.name = "elsewhere/scene.glb";
    moved.warnings = {"a warning"};
    moved.materials[0].name = "renamed";
    EXPECT_TRUE(differences(small_scene(), moved).empty());
}

}  // namespace
}  // namespace relumine
