// SPDX-License-Identifier: Apache-2.0
// pbrt's textures: from parameters to graphs of nodes.
#include "scene/pbrt_textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/message.hpp"
#include "image/byte_image.hpp"
#include "image/srgb.hpp"
#include "relumine/error.hpp"
#include "relumine/image.hpp"
#include "scene/pbrt_transform.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr int max_texture_depth = 64;

/// Kinds that are not read, whose parameters are not checked.
const std::vector<std::string> procedural_types{"dots", "fbm", "wrinkled", "windy", "marble", "ptex"};
bool is_procedural(const std::string& type) {
    return std::ranges::find(procedural_types, type) != procedural_types.end();
}

PbrtMapping read_mapping(const PbrtTexture& texture) {
    const PbrtParameters& p = texture.entity.parameters;
    PbrtMapping m;
    const std::string kind = p.string("mapping", "uv");
    const std::vector<std::string> kinds{"uv", "planar", "spherical", "cylindrical"};
    const auto it = std::ranges::find(kinds, kind);
    if (it == kinds.end())
        p.refuse("mapping", "the mapping " + one_of(kinds), quote(kind) + did_you_mean(kind, kinds));
    m.kind = static_cast<PbrtMapping::Kind>(it - kinds.begin());
    if (m.kind == PbrtMapping::Kind::uv) {
        m.uv = {p.number("uscale", 1), p.number("vscale", 1), p.number("udelta", 0), p.number("vdelta", 0)};
        return m;
    }
    if (m.kind == PbrtMapping::Kind::planar) {
        m.axis_u = p.vector("v1", {1, 0, 0});
        m.axis_v = p.vector("v2", {0, 1, 0});
        m.offset = {p.number("udelta", 0), p.number("vdelta", 0)};
    }
    const std::optional<Transform> inverted = inverse(texture.world_from_texture);
    if (!inverted) refuse_pbrt(p.place(), "a texture transform that can be inverted", "a flat one");
    m.texture_from_world = *inverted;
    return m;
}

/// pbrt's decoding of 8-bit values.
std::function<double(double)> decoder(const std::string& encoding, const PbrtPlace& place) {
    if (encoding == "sRGB" || encoding == "srgb") return linear_from_srgb;
    if (encoding == "linear") return [](double x) { return x; };
    double gamma = 0;
    if (encoding.starts_with("gamma ")) {
        const char* end = encoding.data() + encoding.size();
        const auto [stop, error] = std::from_chars(encoding.data() + 6, end, gamma);
        if (error == std::errc{} && stop == end && gamma > 0)
            return [gamma](double x) { return std::pow(x, gamma); };
    }
    refuse_pbrt(place, "the encoding sRGB, linear or \"gamma <number>\"", quote(encoding));
}

bool is_integer_picture(std::span<const std::uint8_t> bytes) {
    const auto begins = [&](std::initializer_list<int> magic) {
        return bytes.size() >= magic.size()
               && std::equal(magic.begin(), magic.end(), bytes.begin(),
                             [](int a, std::uint8_t b) { return a == b; });
    };
    return begins({0x89, 'P', 'N', 'G'}) || begins({0xff, 0xd8});
}

PbrtPixels integer_pixels(ByteImage image, const std::string& encoding, const PbrtPlace& place) {
    const auto decode = decoder(encoding, place);
    PbrtPixels pixels{image.width, image.height, {}, {}, {}};
    const std::size_t count = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    pixels.rgb.reserve(count);
    std::array<float, 256> table{};
    for (std::size_t i = 0; i < table.size(); ++i) table[i] = static_cast<float>(decode(double(i) / 255));
    bool transparent = false;
    for (std::size_t i = 0; i < count; ++i) {
        const auto channel = [&](std::size_t c) {
            return image.rgba8.empty() ? static_cast<float>(decode(image.rgba16[4 * i + c] / 65535.0))
                                       : table[image.rgba8[4 * i + c]];
        };
        pixels.rgb.push_back({channel(0), channel(1), channel(2)});
        pixels.alpha.push_back(channel(3));  // decoded like the others, as in pbrt
        transparent = transparent || pixels.alpha.back() < 1;
    }
    if (!transparent) pixels.alpha.clear();
    if (encoding == "sRGB" && !image.rgba8.empty())
        pixels.srgb8 = std::make_shared<const ByteImage>(std::move(image));
    return pixels;
}

PbrtPixels float_pixels(const Image& image, const PbrtPlace& place) {
    if (image.layer() == nullptr) refuse_pbrt(place, "a picture with colours", "none");
    PbrtPixels pixels{image.width, image.height, {}, {}, {}};
    pixels.rgb.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height));
    const auto clean = [](float x) { return std::isfinite(x) && x > 0 ? x : 0.0f; };
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            const auto [r, g, b] = image.rgb(x, y);
            pixels.rgb.push_back({clean(r), clean(g), clean(b)});
        }
    }
    return pixels;
}

}  // namespace

PbrtNodeRef constant_node(Spectrum value) {
    auto node = std::make_shared<PbrtNode>();
    node->value = value;
    return node;
}

void collect_leaves(const PbrtNodeRef& node, std::vector<const PbrtNode*>& leaves) {
    const bool coordinates = node->kind == PbrtNode::Kind::image || node->kind == PbrtNode::Kind::bilerp
                             || node->kind == PbrtNode::Kind::checkerboard;
    if (coordinates && std::ranges::find(leaves, node.get()) == leaves.end()) leaves.push_back(node.get());
    for (const PbrtNodeRef& input : node->input)
        if (input) collect_leaves(input, leaves);
}

void collect_direction_mixes(const PbrtNodeRef& node, std::vector<const PbrtNode*>& mixes) {
    if (node->kind == PbrtNode::Kind::direction_mix) mixes.push_back(node.get());
    for (const PbrtNodeRef& input : node->input)
        if (input) collect_direction_mixes(input, mixes);
}

std::shared_ptr<const PbrtPixels> PbrtTextures::pixels(const std::string& file, const std::string& encoding,
                                                       const PbrtPlace& place) {
    const std::string path = files_.resolve(file, place);
    auto& pixels = pixels_[path + '\n' + encoding];
    if (pixels) return pixels;
    try {
        const std::vector<std::uint8_t> bytes = files_.read(file, place);
        if (is_integer_picture(bytes))
            pixels = std::make_shared<const PbrtPixels>(
                integer_pixels(decode_byte_image(bytes, path), encoding, place));
        else
            pixels = std::make_shared<const PbrtPixels>(float_pixels(read_image(path), place));
    } catch (const ImageError& error) {
        throw SceneError{fmt::format("{}: {}", place.text(), error.what())};
    }
    return pixels;
}

PbrtNodeRef PbrtTextures::image_node(const PbrtTexture& texture, bool is_float) {
    const PbrtParameters& p = texture.entity.parameters;
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::image;
    node->mapping = read_mapping(texture);
    node->factor = static_cast<float>(p.number("scale", 1));
    node->invert = p.boolean("invert", false);
    p.ignore({"maxanisotropy"});
    const std::string filter = p.string("filter", "bilinear");
    const std::vector<std::string> filters{"bilinear", "trilinear", "EWA", "ewa", "point"};
    if (std::ranges::find(filters, filter) == filters.end())
        p.refuse("filter", "the filter " + one_of(filters), quote(filter));
    node->nearest = filter == "point";
    const std::string wrap = p.string("wrap", "repeat");
    const std::vector<std::string> wraps{"repeat", "black", "clamp", "octahedralsphere"};
    if (std::ranges::find(wraps, wrap) == wraps.end())
        p.refuse("wrap", "the wrap " + one_of(wraps), quote(wrap) + did_you_mean(wrap, wraps));
    node->wrap = wrap == "repeat" ? Wrap::repeat : Wrap::clamp;
    if (wrap != "repeat" && wrap != "clamp")
        scene_.warn(p.place(), fmt::format("wrap {} is read as \"clamp\"", quote(wrap)));
    const std::string file = p.string("filename", "");
    if (file.empty()) p.refuse("filename", "\"string filename\"", "none");
    node->pixels = pixels(file, p.string("encoding", "sRGB"), p.place());
    if (is_float) {  // the mean of the channels; alpha where the picture has it
        auto grey = std::make_shared<PbrtPixels>(*node->pixels);
        grey->srgb8.reset();
        for (std::size_t i = 0; i < grey->rgb.size(); ++i) {
            const Spectrum c = grey->rgb[i];
            grey->rgb[i] = Spectrum{grey->alpha.empty() ? (c.r + c.g + c.b) / 3 : grey->alpha[i]};
        }
        node->pixels = std::move(grey);
    }
    return node;
}

PbrtNodeRef PbrtTextures::input(const PbrtParameters& p, std::string_view name, double otherwise,
                                bool is_float, PbrtSpectrumUse use) {
    return is_float ? number(p, name, otherwise)
                    : spectrum(p, name, Spectrum{static_cast<float>(otherwise)}, use);
}

PbrtNodeRef PbrtTextures::mix_node(const PbrtParameters& p, bool is_float, PbrtSpectrumUse use,
                                   PbrtNodeRef amount) {
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::mix;
    node->input = {input(p, "tex1", 0, is_float, use), input(p, "tex2", 1, is_float, use), std::move(amount)};
    return node;
}

PbrtNodeRef PbrtTextures::direction_mix_node(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use) {
    const PbrtParameters& p = texture.entity.parameters;
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::direction_mix;
    node->input = {input(p, "tex1", 0, is_float, use), input(p, "tex2", 1, is_float, use), nullptr};
    const auto [x, y, z] = p.vector("dir", {0, 1, 0});
    node->axis = texture.world_from_texture.vector(
        {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
    if (!(length_squared(node->axis) > 0)) p.refuse("dir", "a direction", "none");
    node->axis = normalize(node->axis);
    return node;
}

PbrtNodeRef PbrtTextures::checkerboard_node(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use) {
    const PbrtParameters& p = texture.entity.parameters;
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::checkerboard;
    node->input = {input(p, "tex1", 1, is_float, use), input(p, "tex2", 0, is_float, use), nullptr};
    const int dimension = p.integer("dimension", 2);
    if (dimension != 2 && dimension != 3) p.refuse("dimension", "2 or 3", fmt::format("{}", dimension));
    if (dimension == 2) {
        node->mapping = read_mapping(texture);
        return node;
    }
    scene_.warn(p.place(), "a checkerboard in space is read as an even mix");
    node->kind = PbrtNode::Kind::mix;
    node->input[2] = constant_node(Spectrum{0.5f});
    return node;
}

PbrtNodeRef PbrtTextures::bilerp_node(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use) {
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::bilerp;
    node->mapping = read_mapping(texture);
    const std::array<std::string_view, 4> names{"v00", "v01", "v10", "v11"};
    for (std::size_t i = 0; i < 4; ++i)
        node->corner[i] =
            input(texture.entity.parameters, names[i], i % 2 == 0 ? 0 : 1, is_float, use)->value;
    return node;
}

PbrtNodeRef PbrtTextures::make(const PbrtTexture& texture, bool is_float, PbrtSpectrumUse use) {
    const std::string& type = texture.entity.type;
    const PbrtParameters& p = texture.entity.parameters;
    if (type == "imagemap") return image_node(texture, is_float);
    if (type == "constant") return input(p, "value", 1, is_float, use);
    if (type == "mix") return mix_node(p, is_float, use, number(p, "amount", 0.5));
    if (type == "checkerboard") return checkerboard_node(texture, is_float, use);
    if (type == "bilerp") return bilerp_node(texture, is_float, use);
    if (type == "scale") {
        auto node = std::make_shared<PbrtNode>();
        node->kind = PbrtNode::Kind::scale;
        node->input = {input(p, "tex", 1, is_float, use), number(p, "scale", 1), nullptr};
        return node;
    }
    if (type == "directionmix") return direction_mix_node(texture, is_float, use);
    if (is_procedural(type)) {
        scene_.warn(p.place(), fmt::format("texture {} is not supported and read as 0.5", quote(type)));
        return constant_node(Spectrum{0.5f});
    }
    std::vector<std::string> all{"imagemap", "constant",     "scale",       "mix",
                                 "bilerp",   "checkerboard", "directionmix"};
    all.insert(all.end(), procedural_types.begin(), procedural_types.end());
    refuse_pbrt(p.place(), "a texture among " + one_of(all), quote(type) + did_you_mean(type, all));
}

PbrtNodeRef PbrtTextures::named(const Textures& textures, const PbrtParameter& reference, bool is_float,
                                PbrtSpectrumUse use) {
    const std::string& name = reference.strings[0];
    const auto it = textures.find(name);
    if (it == textures.end()) {
        std::vector<std::string> names;
        for (const auto& [known, texture] : textures) names.push_back(known);
        refuse_pbrt(reference.place, fmt::format("the name of a {} texture", is_float ? "float" : "spectrum"),
                    quote(name) + did_you_mean(name, names));
    }
    const std::string key = fmt::format("{}{}:{}", is_float, static_cast<int>(use), name);
    if (const auto made = made_.find(key); made != made_.end()) return made->second;
    if (depth_ >= max_texture_depth)
        refuse_pbrt(reference.place, fmt::format("at most {} textures in a row", max_texture_depth),
                    "more, or a circle");
    ++depth_;
    PbrtNodeRef node = make(it->second, is_float, use);
    --depth_;
    if (!is_procedural(it->second.entity.type)) it->second.entity.parameters.finish();
    made_[key] = node;
    return node;
}

PbrtNodeRef PbrtTextures::spectrum_or_null(const PbrtParameters& p, std::string_view name,
                                           PbrtSpectrumUse use) {
    if (const PbrtParameter* reference = p.find_texture(name))
        return named(scene_.spectrum_textures, *reference, false, use);
    if (const PbrtParameter* value = p.find_spectrum(name))
        return constant_node(pbrt_rgb(*value, use, files_));
    return {};
}

PbrtNodeRef PbrtTextures::spectrum(const PbrtParameters& p, std::string_view name, Spectrum otherwise,
                                   PbrtSpectrumUse use) {
    PbrtNodeRef node = spectrum_or_null(p, name, use);
    return node ? node : constant_node(otherwise);
}

PbrtNodeRef PbrtTextures::number_or_null(const PbrtParameters& p, std::string_view name) {
    if (const PbrtParameter* reference = p.find_texture(name))
        return named(scene_.float_textures, *reference, true, PbrtSpectrumUse::unbounded);
    if (p.find("float", name)) return constant_node(Spectrum{static_cast<float>(p.number(name, 0))});
    return {};
}

PbrtNodeRef PbrtTextures::number(const PbrtParameters& p, std::string_view name, double otherwise) {
    PbrtNodeRef node = number_or_null(p, name);
    return node ? node : constant_node(Spectrum{static_cast<float>(otherwise)});
}

}  // namespace relumine
