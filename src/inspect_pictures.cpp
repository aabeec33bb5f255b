// SPDX-License-Identifier: Apache-2.0
// The steps of reprojection as pictures [V, fig. 1].
#include <fmt/format.h>

#include <numeric>

#include "base/hash.hpp"
#include "base/oklab.hpp"
#include "base/rgbe.hpp"
#include "inspect_steps.hpp"
#include "relumine/compare.hpp"

namespace relumine {
namespace {

// Linear Rec. 709.
constexpr Spectrum covered_colour{0.05f, 0.35f, 0.12f};   // green
constexpr Spectrum unknown_colour{0.9f, 0.4f, 0.02f};     // orange
constexpr Spectrum gap_colour{0.25f, 0.02f, 0.3f};        // purple
constexpr Spectrum gap_ray_colour{1, 1, 1};               // white
constexpr Spectrum infinity_colour{0.55f, 0.65f, 0.75f};  // pale blue-grey
constexpr float dimmed = 0.25f;

template <typename ColourAt>
Image square_picture(int side, const std::string& unit, const ColourAt& colour_at) {
    Image image{side, side, {0, 0, side, side}, side, side, {}, {{"unit", unit}}};
    Layer& layer = image.layers.emplace_back(Layer{"", {"R", "G", "B"}, {}});
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Spectrum c = colour_at(x, y);
            layer.pixels.insert(layer.pixels.end(), {c.r, c.g, c.b});
        }
    return image;
}

std::size_t bit_at(int x, int y) { return static_cast<std::size_t>(y * mask_side + x); }

Image radiance_picture(const std::vector<std::uint32_t>& packed, int side) {
    return square_picture(side, "radiance", [&](int x, int y) {
        return unpack_rgbe(packed[static_cast<std::size_t>(y * side + x)]);
    });
}

/// Which surfel each texel belongs to.
std::vector<std::uint32_t> surfel_of_texel(const Record& record) {
    std::vector<std::uint32_t> surfels(record.radiance.size());
    for (std::uint32_t i = 0; i < record.surfels.count; ++i) {
        const TexelRect& r = record.surfels.texels[i];
        for (int v = r.v; v < r.v + r.height; ++v)
            for (int u = r.u; u < r.u + r.width; ++u)
                surfels[static_cast<std::size_t>(v * record.side + u)] = i;
    }
    return surfels;
}

/// From near (bright yellow) over green to far (dark violet): lightness falls evenly.
Spectrum depth_colour(float far) {
    const float lightness = 0.93f - 0.63f * far, chroma = 0.16f, hue = (100 + 200 * far) * pi / 180;
    return rgb_from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
}

Image layers_picture(const Record& record) {
    const std::vector<std::uint32_t> surfels = surfel_of_texel(record);
    const std::vector<std::uint32_t>& begin = record.surfels.layer_begin;
    const std::size_t hit_layers = record.surfels.layers() - 1;
    return square_picture(record.side, "colour", [&](int x, int y) {
        const std::uint32_t surfel = surfels[static_cast<std::size_t>(y * record.side + x)];
        const auto layer =
            static_cast<std::size_t>(std::ranges::upper_bound(begin, surfel) - begin.begin()) - 1;
        if (layer >= hit_layers) return infinity_colour;
        return depth_colour(static_cast<float>(layer)
                            / static_cast<float>(std::max(hit_layers - 1, std::size_t{1})));
    });
}

Spectrum colour_of_number(std::uint32_t number) {
    const std::uint64_t random = hash(number, 0x73757266656c);
    const float hue = 2 * pi * unit_float(static_cast<std::uint32_t>(random));
    const float lightness = 0.45f + 0.4f * unit_float(static_cast<std::uint32_t>(random >> 32));
    return rgb_from_oklab(lightness, 0.12f * std::cos(hue), 0.12f * std::sin(hue));
}

Image surfels_picture(const Record& record) {
    const std::vector<std::uint32_t> surfels = surfel_of_texel(record);
    return square_picture(record.side, "colour", [&](int x, int y) {
        return colour_of_number(surfels[static_cast<std::size_t>(y * record.side + x)]);
    });
}

/// Uncovered bits show a checker of dark magenta, as bright as a part of what was seen, whatever its
/// exposure.
Image reprojected_picture(const InspectedPoint& p) {
    float sum = 0;
    for (const std::uint32_t packed : p.truth.radiance) sum += luminance(unpack_rgbe(packed));
    const float light = sum > 0 ? sum / mask_bits : 1;
    return square_picture(mask_side, "radiance", [&](int x, int y) {
        if (p.covered.test(x, y)) return unpack_rgbe(p.reprojected[bit_at(x, y)]);
        return Spectrum{0.3f, 0, 0.3f} * ((x / 4 + y / 4) % 2 == 0 ? light : 0.5f * light);
    });
}

Spectrum mask_colour(const InspectedPoint& p, int x, int y) {
    return p.covered.test(x, y) ? covered_colour : p.unknown.test(x, y) ? unknown_colour : gap_colour;
}

Image masks_picture(const InspectedPoint& p) {
    return square_picture(mask_side, "colour", [&](int x, int y) { return mask_colour(p, x, y); });
}

Image gap_rays_picture(const InspectedPoint& p) {
    Mask rays;
    for (const GapRay& ray : p.gap_rays)
        rays.fill({ray.x, static_cast<std::uint8_t>(ray.x + 1), ray.y, static_cast<std::uint8_t>(ray.y + 1)});
    return square_picture(mask_side, "colour", [&](int x, int y) {
        return rays.test(x, y) ? gap_ray_colour : mask_colour(p, x, y) * dimmed;
    });
}

/// f·|cos θ| of every bit.
std::vector<Spectrum> bsdf_of_bits(const BsdfTable& table) {
    std::vector<Spectrum> bits(mask_bits);
    const auto corner = [](std::size_t cell) {
        return cell / cell_side * 2 * mask_side + cell % cell_side * 2;
    };
    for (std::size_t cell = 0; cell < cell_count; ++cell)
        for (std::size_t bit = 0; bit < 4; ++bit)
            bits[corner(cell) + bit / 2 * mask_side + bit % 2] = {table.r[cell], table.g[cell],
                                                                  table.b[cell]};
    for (std::size_t fine = 0; fine < table.fine_cells.size(); ++fine)
        for (std::size_t bit = 0; bit < 4; ++bit)
            bits[corner(table.fine_cells[fine]) + bit / 2 * mask_side + bit % 2] =
                table.fine_bits[4 * fine + bit];
    return bits;
}

/// The value above which a thousandth of the square lies, or the greatest where that is 0, or 1.
float shown_as_one(const std::vector<Spectrum>& values) {
    std::vector<float> sizes;
    for (const Spectrum& value : values) sizes.push_back(max_component(value));
    std::ranges::sort(sizes);
    const float nearly_all = sizes[sizes.size() - 1 - sizes.size() / 1000];
    return nearly_all > 0 ? nearly_all : sizes.back() > 0 ? sizes.back() : 1;
}

Image scaled_picture(const std::vector<Spectrum>& values) {
    const float one = shown_as_one(values);
    Image image =
        square_picture(mask_side, "scaled", [&](int x, int y) { return values[bit_at(x, y)] / one; });
    image.metadata["scale"] = fmt::format("{}", one);
    return image;
}

Image product_picture(const InspectedPoint& p) {
    std::vector<Spectrum> product = bsdf_of_bits(p.bsdf);
    for (std::size_t i = 0; i < product.size(); ++i) product[i] *= unpack_rgbe(p.filled.radiance[i]);
    return scaled_picture(product);
}

Image error_picture(const Image& filled, const Image& truth) {
    Image image = signed_difference(filled, truth);
    image.metadata["unit"] = "colour";
    image.metadata["scale"] = image.metadata["difference_scale"];
    return image;
}

}  // namespace

std::vector<NamedPicture> draw_pictures(const InspectedPoint& p) {
    const Record& record = p.best_record();
    const Image filled = radiance_picture(p.filled.radiance, mask_side);
    const Image truth = radiance_picture(p.truth.radiance, mask_side);
    return {{"record", radiance_picture(record.radiance, record.side)},
            {"layers", layers_picture(record)},
            {"surfels", surfels_picture(record)},
            {"reprojected", reprojected_picture(p)},
            {"masks", masks_picture(p)},
            {"gap_rays", gap_rays_picture(p)},
            {"filled", filled},
            {"bsdf", scaled_picture(bsdf_of_bits(p.bsdf))},
            {"product", product_picture(p)},
            {"truth", truth},
            {"error", error_picture(filled, truth)}};
}

}  // namespace relumine
