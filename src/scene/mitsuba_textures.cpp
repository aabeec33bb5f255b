// SPDX-License-Identifier: Apache-2.0
// Mitsuba's bitmaps, checkerboards and scaled textures.
#include "scene/mitsuba_textures.hpp"

#include <fmt/format.h>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr int max_depth = 16;

/// Scales and offsets of `to_uv` in coordinates whose v grows upwards; Mitsuba's grows downwards. `periods`:
/// cells of a checkerboard per unit.
PbrtMapping mapping_of(MitsubaProperties& p, double periods) {
    const Transform t = p.transform("to_uv");
    if (t.m[0][1] != 0 || t.m[1][0] != 0)
        p.refuse("to_uv", "a transform that scales and moves along u and v", "one that turns");
    if (t.m[0][0] == 0 || t.m[1][1] == 0) p.refuse("to_uv", "a transform that can be inverted", "a flat one");
    PbrtMapping mapping;
    const double su = t.m[0][0] * periods, sv = t.m[1][1] * periods;
    mapping.uv = {su, sv, t.m[0][3] * periods, 1 - sv - t.m[1][3] * periods};
    return mapping;
}

PbrtNodeRef grey(const PbrtNodeRef& node) {
    if (is_constant(node)) return constant_node(Spectrum{luminance(node->value)});
    auto copy = std::make_shared<PbrtNode>(*node);
    for (PbrtNodeRef& input : copy->input)
        if (input) input = grey(input);
    if (!node->pixels) return copy;
    auto pixels = std::make_shared<PbrtPixels>(*node->pixels);
    pixels->srgb8.reset();
    for (Spectrum& c : pixels->rgb) c = Spectrum{luminance(c)};
    copy->pixels = std::move(pixels);
    return copy;
}

}  // namespace

PbrtNodeRef MitsubaTextures::bitmap(MitsubaProperties& p) {
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::image;
    node->mapping = mapping_of(p, 1);
    node->nearest = p.choice("filter_type", {"bilinear", "nearest"}) == "nearest";
    const std::string wrap = p.choice("wrap_mode", {"repeat", "mirror", "clamp"});
    node->wrap = wrap == "repeat" ? Wrap::repeat : wrap == "mirror" ? Wrap::mirror : Wrap::clamp;
    const bool raw = p.boolean("raw", false);
    p.ignore({"accel", "format"});
    const std::string file = p.string("filename", "");
    if (file.empty()) p.refuse("filename", "<string name=\"filename\">", "none");
    node->pixels = baker_.pixels(file, raw ? "linear" : "sRGB", p.object().place);
    return node;
}

PbrtNodeRef MitsubaTextures::checkerboard(MitsubaProperties& p, MitsubaColorUse use) {
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::checkerboard;
    node->mapping = mapping_of(p, 2);
    node->input = {color(p, "color0", Spectrum{0.4f}, use), color(p, "color1", Spectrum{0.2f}, use), nullptr};
    return node;
}

PbrtNodeRef MitsubaTextures::scale(MitsubaProperties& p, MitsubaColorUse use) {
    auto node = std::make_shared<PbrtNode>();
    node->kind = PbrtNode::Kind::scale;
    PbrtNodeRef scaled;
    for (const MitsubaElement* inner : p.objects("texture")) scaled = this->node(*inner, use);
    if (!scaled) scaled = color(p, "value", Spectrum{1}, use);
    node->input = {std::move(scaled), color(p, "scale", Spectrum{1}, MitsubaColorUse::unbounded), nullptr};
    return node;
}

PbrtNodeRef MitsubaTextures::node(const MitsubaElement& element, MitsubaColorUse use) {
    if (element.tag != "texture") return constant_node(mitsuba_color(element, use, scene_));
    PbrtNodeRef& known = made_[{&element, use}];
    if (known) return known;
    if (++depth_ > max_depth)
        refuse_pbrt(element.place, fmt::format("at most {} textures in a row", max_depth),
                    "more, or a circle");
    MitsubaProperties p(element, scene_);
    PbrtNodeRef node;
    const std::vector<std::string> types{"bitmap", "checkerboard", "scale"};
    if (element.type == "bitmap")
        node = bitmap(p);
    else if (element.type == "checkerboard")
        node = checkerboard(p, use);
    else if (element.type == "scale")
        node = scale(p, use);
    else
        refuse_pbrt(element.place, "a texture among " + one_of(types),
                    quote(element.type) + did_you_mean(element.type, types));
    p.finish();
    --depth_;
    return made_[{&element, use}] = node;
}

PbrtNodeRef MitsubaTextures::color(MitsubaProperties& p, std::string_view name, Spectrum otherwise,
                                   MitsubaColorUse use) {
    const MitsubaElement* element = p.find(name);
    return element ? node(*element, use) : constant_node(otherwise);
}

PbrtNodeRef MitsubaTextures::number(MitsubaProperties& p, std::string_view name, double otherwise) {
    const MitsubaElement* element = p.find(name);
    if (!element) return constant_node(Spectrum{static_cast<float>(otherwise)});
    return grey(node(*element, MitsubaColorUse::unbounded));
}

}  // namespace relumine
