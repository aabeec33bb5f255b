// SPDX-License-Identifier: Apache-2.0
// Reading textures.
#include "shading/texture.hpp"

namespace relumine {
namespace {

float srgb_to_linear(float x) { return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f); }

std::array<float, 256> make_srgb_table() {
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = srgb_to_linear(static_cast<float>(i) / 255);
    return table;
}
const std::array<float, 256> srgb_table = make_srgb_table();

int wrap_texel(int i, int size, Wrap wrap) {
    if (wrap == Wrap::clamp) return std::clamp(i, 0, size - 1);
    const int period = wrap == Wrap::mirror ? 2 * size : size;
    i = (i % period + period) % period;
    return i < size ? i : period - 1 - i;
}

Vec4 texel(const ByteImage& image, int x, int y, Encoding encoding) {
    const std::size_t at =
        4
        * (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x));
    if (!image.rgba8.empty()) {
        const std::uint8_t* p = &image.rgba8[at];
        const float a = static_cast<float>(p[3]) / 255;
        if (encoding == Encoding::srgb) return {srgb_table[p[0]], srgb_table[p[1]], srgb_table[p[2]], a};
        return {static_cast<float>(p[0]) / 255, static_cast<float>(p[1]) / 255,
                static_cast<float>(p[2]) / 255, a};
    }
    const std::uint16_t* p = &image.rgba16[at];
    const auto unit = [](std::uint16_t v) { return static_cast<float>(v) / 65535; };
    const auto decode = [&](std::uint16_t v) {
        return encoding == Encoding::srgb ? srgb_to_linear(unit(v)) : unit(v);
    };
    return {decode(p[0]), decode(p[1]), decode(p[2]), unit(p[3])};
}

Vec4 mix_texels(Vec4 a, Vec4 b, float t) {
    return {lerp(a.x, b.x, t), lerp(a.y, b.y, t), lerp(a.z, b.z, t), lerp(a.w, b.w, t)};
}

/// Into the range where float texel arithmetic is exact enough; coordinates beyond have no meaningful
/// fraction anyway.
float tame(float coordinate) {
    return std::isfinite(coordinate) ? std::clamp(coordinate, -1e4f, 1e4f) : 0.0f;
}

/// `uv`: before the texture's own transform.
Vec4 sample_image(const ByteImage& image, const TextureRef& texture, Vec2 uv, Encoding encoding) {
    const auto& m = texture.uv_transform;
    const float x = tame(m[0] * uv.x + m[1] * uv.y + m[2]) * static_cast<float>(image.width);
    const float y = tame(m[3] * uv.x + m[4] * uv.y + m[5]) * static_cast<float>(image.height);
    const auto at = [&](int i, int j) {
        return texel(image, wrap_texel(i, image.width, texture.wrap_u),
                     wrap_texel(j, image.height, texture.wrap_v), encoding);
    };
    if (texture.nearest) return at(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
    const float left = std::floor(x - 0.5f), top = std::floor(y - 0.5f);
    const int i = static_cast<int>(left), j = static_cast<int>(top);
    const float s = x - 0.5f - left, t = y - 0.5f - top;
    return mix_texels(mix_texels(at(i, j), at(i + 1, j), s), mix_texels(at(i, j + 1), at(i + 1, j + 1), s),
                      t);
}

}  // namespace

Vec4 sample_texture(const SceneData& scene, const TextureRef& texture, const TextureUv& uv,
                    Encoding encoding) {
    const Vec2 at = uv.sets[static_cast<std::size_t>(texture.uv_set)];
    const Vec4 value = sample_image(scene.images[index(texture.image)], texture, at, encoding);
    if (!texture.turned_away) return value;
    return mix_texels(sample_image(scene.images[index(*texture.turned_away)], texture, at, encoding), value,
                      uv.facing);
}

}  // namespace relumine
