// SPDX-License-Identifier: Apache-2.0
// Renders one glowing triangle that fills the view: every pixel must be the triangle's radiance.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <relumine/error.hpp>
#include <relumine/image.hpp>
#include <relumine/render.hpp>
#include <relumine/scene.hpp>

namespace {

constexpr std::array<float, 3> radiance{1, 2, 4};

relumine::Scene glowing_triangle() {
    constexpr std::array<std::array<float, 3>, 3> positions{
        {{-100, -100, -1}, {100, -100, -1}, {0, 100, -1}}};
    constexpr std::array<std::array<std::uint32_t, 3>, 1> triangles{
        {{0, 1, 2}}};  // counter-clockwise: faces the camera

    relumine::SceneBuilder builder;
    const std::size_t glow =
        builder.add_material({.name = "glow", .base_color = {0, 0, 0}, .emission = radiance});
    const std::size_t mesh = builder.add_mesh({.name = "triangle",
                                               .positions = positions,
                                               .normals = {},
                                               .uvs = {},
                                               .triangles = triangles,
                                               .material = glow});
    builder.add_instance(mesh);
    builder.add_camera({.name = "front"});
    return builder.build();
}

bool every_pixel_glows(const relumine::Image& image) {
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t channel = 0; channel < 3; ++channel)
                if (std::abs(image.rgb(x, y)[channel] - radiance[channel]) > 1e-5f * radiance[channel])
                    return false;
    return image.width == 8 && image.height == 8;
}

}  // namespace

int main() {
    try {
        // A path of depth 0 is emission alone, so the answer is exact.
        const relumine::Image image =
            relumine::render(glowing_triangle(),
                             {.samples_per_pixel = 4, .max_depth = 0, .width = 8, .height = 8, .threads = 1});
        if (every_pixel_glows(image)) return 0;
        std::fprintf(stderr, "expected radiance 1 2 4 in each of 8 × 8 pixels, found another picture\n");
    } catch (const relumine::Error& error) {
        std::fprintf(stderr, "%s\n", error.what());
    }
    return 1;
}
