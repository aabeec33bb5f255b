// SPDX-License-Identifier: Apache-2.0
// pbrt scenes in strings, for tests.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scene/finish_scene.hpp"
#include "scene/readers.hpp"
#include "scene/test_files.hpp"

namespace relumine::test::pbrt {

inline constexpr const char* triangle =
    "Shape \"trianglemesh\" \"point3 P\" [0 0 0  1 0 0  0 1 0] \"integer indices\" [0 1 2]\n";

inline SceneData read(const TempFolder& folder, const std::string& world, const std::string& options = "") {
    return read_pbrt(folder.write("scene.pbrt", options + "\nWorldBegin\n" + world));
}
inline SceneData read(const std::string& world, const std::string& options = "") {
    const TempFolder folder;
    return read(folder, world, options);
}
inline SceneData finished(const std::string& world) { return finish_scene(read(world)); }

inline bool warns(const SceneData& scene, const std::string& text) {
    return std::ranges::any_of(
        scene.warnings, [&](const std::string& warning) { return warning.find(text) != warning.npos; });
}

inline void expect_near(Vec3 a, Vec3 b, float tolerance = 1e-5f) {
    EXPECT_NEAR(a.x, b.x, tolerance);
    EXPECT_NEAR(a.y, b.y, tolerance);
    EXPECT_NEAR(a.z, b.z, tolerance);
}
inline void expect_near(Spectrum a, Spectrum b, float tolerance = 1e-5f) {
    expect_near(Vec3{a.r, a.g, a.b}, Vec3{b.r, b.g, b.b}, tolerance);
}

}  // namespace relumine::test::pbrt
