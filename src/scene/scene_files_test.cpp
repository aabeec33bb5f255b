// SPDX-License-Identifier: Apache-2.0
// What a scene may open: its own folder and those that are allowed, and nothing else by any way around.
#include "scene/scene_files.hpp"

#include <gtest/gtest.h>

#include "relumine/error.hpp"
#include "relumine/scene.hpp"
#include "scene/test_files.hpp"

namespace relumine {
namespace {

using test::TempFolder;

/// A scene's folder, one that may be allowed, and one that never is; each with a file.
struct Place {
    TempFolder folder;
    std::string scene = folder.write("scene/a.gltf", "");
    std::string inside = folder.write("scene/parts/in.bin", "in");
    std::string allowed = folder.write("library/deep/ok.bin", "ok");
    std::string secret = folder.write("secret/no.bin", "no");

    Place() {
        std::filesystem::create_symlink(allowed, folder.path("scene/link-to-library.bin"));
        std::filesystem::create_symlink(secret, folder.path("scene/link-to-secret.bin"));
        std::filesystem::create_symlink(secret, folder.path("library/link-to-secret.bin"));
        std::filesystem::create_directory_symlink(folder.path("library"), folder.path("alias"));
    }
};

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

/// What the file holds, or "refused: " and why.
std::string read(const Place& place, const std::string& name, const std::vector<std::string>& allowed) {
    SceneFiles by_name(place.scene, allowed), by_uri(place.scene, allowed);
    std::string result, result_of_uri;
    try {
        result = text_of(by_name.read(name, "here"));
    } catch (const SceneError& error) {
        result = std::string("refused: ") + error.what();
    }
    try {
        result_of_uri = text_of(by_uri.read_uri(name, "here"));
    } catch (const SceneError& error) {
        result_of_uri = std::string("refused: ") + error.what();
    }
    EXPECT_EQ(result, result_of_uri) << name;
    return result;
}

TEST(LoadSceneFiles, OnlyTheScenesFolderWithoutLeave) {
    const Place place;
    EXPECT_EQ(read(place, "parts/in.bin", {}), "in");
    EXPECT_EQ(read(place, "parts/../parts/in.bin", {}), "in");
    for (const std::string& name : {std::string("../library/deep/ok.bin"), place.allowed, place.inside})
        EXPECT_EQ(read(place, name, {}), "refused: here: expected a file inside the scene's folder, found \""
                                             + name + "\", which leads outside");
    EXPECT_EQ(
        read(place, "link-to-library.bin", {}),
        "refused: here: expected a file inside the scene's folder, found \"link-to-library.bin\", a link "
        "that leads outside");
}

TEST(LoadSceneFiles, AnAllowedFolderOpensItselfAlone) {
    const Place place;
    for (const std::string folder : {"library", "library/", "alias", "library/deep", "secret/../library"}) {
        const std::vector<std::string> allowed{place.folder.path(folder)};
        SCOPED_TRACE(folder);
        EXPECT_EQ(read(place, "../library/deep/ok.bin", allowed), "ok");
        EXPECT_EQ(read(place, place.allowed, allowed), "ok");
        EXPECT_EQ(read(place, "link-to-library.bin", allowed), "ok");
        EXPECT_EQ(read(place, place.inside, allowed), "in");
        for (const std::string& name :
             {std::string("../secret/no.bin"), place.secret, std::string("link-to-secret.bin"),
              std::string("../library/link-to-secret.bin"), std::string("../library/../secret/no.bin")})
            EXPECT_TRUE(read(place, name, allowed)
                            .starts_with("refused: here: expected a file inside the scene's folder or an "
                                         "allowed one, found"))
                << name;
    }
}

TEST(LoadSceneFiles, AFolderWhoseNameBeginsAlikeIsAnother) {
    const Place place;
    (void)place.folder.write("library-of-others/no.bin", "no");
    EXPECT_TRUE(
        read(place, "../library-of-others/no.bin", {place.folder.path("library")}).starts_with("refused"));
}

TEST(LoadSceneFiles, NamesBesideAnAllowedFileAreFoundThere) {
    const Place place;
    SceneFiles files(place.scene, {place.folder.path("library")});
    EXPECT_EQ(text_of(files.read("ok.bin", "here", place.allowed)), "ok");
    SceneFiles strict(place.scene);
    EXPECT_THROW((void)strict.read("ok.bin", "here", place.allowed), SceneError);
}

TEST(LoadSceneFiles, TooManyFilesAreRefused) {
    const Place place;
    SceneFiles files(place.scene);
    for (std::size_t i = 0; i < max_scene_files; ++i) (void)files.read_uri("data:;base64,", "here");
    EXPECT_THROW((void)files.read_uri("data:;base64,", "here"), SceneError);
}

TEST(LoadSceneFiles, TooManyBytesAreRefused) {
    const Place place;
    const std::string large = place.folder.write("scene/large.bin", "");
    std::filesystem::resize_file(large, max_scene_file_bytes + 1);  // a hole: no disk is filled
    SceneFiles files(place.scene);
    EXPECT_THROW((void)files.read("large.bin", "here"), SceneError);
    EXPECT_THROW((void)files.read_uri("large.bin", "here"), SceneError);
}

TEST(LoadSceneFiles, EveryFormatAsksForTheSameLeave) {
    const Place place;
    (void)place.folder.write("library/world.pbrt", "Shape \"sphere\"");
    (void)place.folder.write("scene/a.pbrt", "WorldBegin\nInclude \"../library/world.pbrt\"\n");
    test::GltfBuilder builder = test::triangle_document();
    (void)place.folder.write("library/a.bin", builder.binary);
    builder.document["buffers"] = {{{"byteLength", builder.binary.size()}, {"uri", "../library/a.bin"}}};
    (void)place.folder.write("scene/b.gltf", builder.json_text());
    for (const std::string name : {"scene/a.pbrt", "scene/b.gltf"}) {
        const std::string path = place.folder.path(name);
        EXPECT_THROW((void)load_scene(path), SceneError) << name;
        SceneOptions options;
        options.allowed_folders = {place.folder.path("library")};
        EXPECT_EQ(load_scene(path, options).info().meshes, 1u) << name;
        options.allowed_folders = {place.folder.path("none")};
        EXPECT_THROW((void)load_scene(path, options), SettingsError) << name;
    }
}

}  // namespace
}  // namespace relumine
