// SPDX-License-Identifier: Apache-2.0
// The regression pictures: which scenes, what they show, and which methods are held to them.
#pragma once

#include <string>
#include <vector>

#include "relumine/render.hpp"

namespace relumine::pictures {

/// A tiny scene and how it is seen. Its reference is made by `path`, which is unbiased.
struct PictureCase {
    std::string name, file,
        environment;            // files in tests/pictures/scenes, or below scenes/ where they begin with "/"
    std::string shows;          // what would go wrong here
    int samples = 64;           // camera samples per pixel of the test's render by `path`
    RenderSettings settings{};  // what the reference has too: depth, filter
    std::string layer{};        // compared instead of the picture itself; "": that
};
[[nodiscard]] const std::vector<PictureCase>& picture_cases();

/// The largest differences to a reference that a method may have.
struct Tolerance {
    double mean;   // |Σ L / Σ Lref − 1|
    double block;  // relative difference of means of 8 × 8 pixels, the worst block
    double flip;
};

/// A picture by another method than `path`: held to the same reference within a tolerance.
struct MethodCase {
    std::string picture, label;
    RenderSettings settings;  // without what the picture has
    Tolerance tolerance;
};
[[nodiscard]] const std::vector<MethodCase>& method_cases();

[[nodiscard]] const PictureCase& find_picture(const std::string& name);

/// What a render of the picture by `path` takes, or by the method of `settings`.
[[nodiscard]] RenderSettings path_settings(const PictureCase& picture);
[[nodiscard]] RenderSettings method_settings(const PictureCase& picture, RenderSettings settings);

[[nodiscard]] Scene load_picture_scene(const PictureCase& picture);

/// The picture, or the layer that is compared in its place.
[[nodiscard]] Image render_picture(const PictureCase& picture, const Scene& scene, RenderSettings settings);

}  // namespace relumine::pictures
