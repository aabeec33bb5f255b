// SPDX-License-Identifier: Apache-2.0
// pbrt's graphics state.
#include "scene/pbrt_state.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr std::size_t max_saved_states = 10'000;

template <typename Map>
std::vector<std::string> names_of(const Map& map) {
    std::vector<std::string> names;
    for (const auto& [name, value] : map) names.push_back(name);
    return names;
}

}  // namespace

void PbrtScene::warn(const PbrtPlace& place, const std::string& text) {
    constexpr std::size_t limit = 200;  // SceneData shows half of them
    if (warnings.size() < limit) warnings.push_back(place.text() + ": " + text);
}

PbrtState::PbrtState() { scene_.materials.push_back({"diffuse", PbrtParameters{"diffuse", {}, {}}}); }

void PbrtState::needs_world(const PbrtPlace& place, std::string_view directive) const {
    if (!in_world_) refuse_pbrt(place, "WorldBegin before the scene's description", directive);
}
void PbrtState::needs_options(const PbrtPlace& place, std::string_view directive) const {
    if (in_world_) refuse_pbrt(place, "the scene's description after WorldBegin", directive);
}

PbrtEntity PbrtState::entity(const std::string& type, std::vector<PbrtParameter> parameters,
                             const PbrtPlace& place, const std::string& target) const {
    const auto it = state_.attributes.find(target);
    if (it == state_.attributes.end()) return {type, PbrtParameters{type, place, std::move(parameters)}};
    return {type, PbrtParameters{type, place, std::move(parameters), it->second}};
}

void PbrtState::begin_world(const PbrtPlace& place) {
    needs_options(place, "WorldBegin");
    in_world_ = true;
    state_.ctm = Transform{};
    state_.transforms_active = true;
    named_transforms_["world"] = state_.ctm;
}

void PbrtState::push(const PbrtPlace& place) {
    if (stack_.size() >= max_saved_states)
        refuse_pbrt(place, fmt::format("at most {} nested AttributeBegin", max_saved_states), "more");
    stack_.push_back({state_, place, false});
}

void PbrtState::pop(const PbrtPlace& place) {
    if (stack_.empty()) refuse_pbrt(place, "AttributeBegin before AttributeEnd", "none");
    if (stack_.back().object)
        refuse_pbrt(place, "ObjectEnd for the ObjectBegin at " + stack_.back().place.text(), "AttributeEnd");
    state_ = std::move(stack_.back().state);
    stack_.pop_back();
}

void PbrtState::begin_object(const std::string& name, const PbrtPlace& place) {
    needs_world(place, "ObjectBegin");
    if (object_) refuse_pbrt(place, "no ObjectBegin inside of another", "one");
    push(place);
    stack_.back().object = true;
    if (!scene_.objects.try_emplace(name).second)
        refuse_pbrt(place, "a new name for the object", quote(name) + ", which exists");
    object_ = name;
}

void PbrtState::end_object(const PbrtPlace& place) {
    if (!object_) refuse_pbrt(place, "ObjectBegin before ObjectEnd", "none");
    if (!stack_.back().object)
        refuse_pbrt(place, "AttributeEnd for the AttributeBegin at " + stack_.back().place.text(),
                    "ObjectEnd");
    state_ = std::move(stack_.back().state);
    stack_.pop_back();
    object_.reset();
}

void PbrtState::add_instance(const std::string& name, const PbrtPlace& place) {
    needs_world(place, "ObjectInstance");
    if (object_) refuse_pbrt(place, "no ObjectInstance inside of an object", "one");
    scene_.instances.push_back({name, place, state_.ctm});
}

void PbrtState::concat(const Transform& transform) {
    if (state_.transforms_active) state_.ctm = state_.ctm * transform;
}
void PbrtState::set_transform(const Transform& transform) {
    if (state_.transforms_active) state_.ctm = transform;
}
void PbrtState::name_transform(const std::string& name) { named_transforms_[name] = state_.ctm; }
void PbrtState::use_named_transform(const std::string& name, const PbrtPlace& place) {
    const auto it = named_transforms_.find(name);
    if (it == named_transforms_.end())
        refuse_pbrt(place, "a coordinate system that was named before",
                    quote(name) + did_you_mean(name, names_of(named_transforms_)));
    state_.ctm = it->second;
}

void PbrtState::set_active_transform(const PbrtToken& which) {
    const std::vector<std::string> names{"All", "StartTime", "EndTime"};
    if (which.kind != PbrtToken::Kind::word || std::ranges::find(names, which.text) == names.end())
        refuse_pbrt(which.place, one_of(names), describe(which) + did_you_mean(which.text, names));
    state_.transforms_active = which.text != "EndTime";
    if (which.text == "EndTime")
        scene_.warn(which.place, "motion is not rendered: everything stands where it starts");
}

void PbrtState::set_option(const std::string& directive, const std::string& type,
                           std::vector<PbrtParameter> parameters, const PbrtPlace& place) {
    needs_options(place, directive);
    PbrtEntity option = entity(type, std::move(parameters), place);
    if (directive == "Camera") {
        const std::optional<Transform> world_from_camera = inverse(state_.ctm);
        if (!world_from_camera) refuse_pbrt(place, "a camera transform that can be inverted", "a flat one");
        scene_.camera_from_world = state_.ctm;
        named_transforms_["camera"] = *world_from_camera;
        scene_.camera = std::move(option);
    } else if (directive == "Film") {
        scene_.film = std::move(option);
    } else if (directive == "Integrator") {
        scene_.integrator = std::move(option);
    } else if (directive == "Sampler") {
        scene_.sampler = std::move(option);
    }
}

void PbrtState::set_attribute(const std::string& target, std::vector<PbrtParameter> parameters,
                              const PbrtPlace& place) {
    const std::vector<std::string> targets{"shape", "light", "material", "medium", "texture"};
    if (std::ranges::find(targets, target) == targets.end())
        refuse_pbrt(place, "the attribute target " + one_of(targets),
                    quote(target) + did_you_mean(target, targets));
    for (PbrtParameter& p : parameters) {
        p.optional = true;
        state_.attributes[target].push_back(std::move(p));
    }
}

void PbrtState::set_material(const std::string& type, std::vector<PbrtParameter> parameters,
                             const PbrtPlace& place) {
    needs_world(place, "Material");
    state_.material = {scene_.materials.size(), "", place};
    scene_.materials.push_back(entity(type, std::move(parameters), place, "material"));
}

void PbrtState::make_named_material(const std::string& name, std::vector<PbrtParameter> parameters,
                                    const PbrtPlace& place) {
    needs_world(place, "MakeNamedMaterial");
    if (scene_.named_materials.contains(name))
        refuse_pbrt(place, "a new name for the material", quote(name) + ", which exists");
    PbrtEntity material = entity(name, std::move(parameters), place, "material");
    material.type = material.parameters.string("type", "");
    if (material.type.empty())
        refuse_pbrt(place, "\"string type\" in MakeNamedMaterial " + quote(name), "none");
    scene_.named_materials.emplace(name, std::move(material));
}

void PbrtState::use_named_material(const std::string& name, const PbrtPlace& place) {
    needs_world(place, "NamedMaterial");
    state_.material = {0, name, place};
}

void PbrtState::set_area_light(const std::string& type, std::vector<PbrtParameter> parameters,
                               const PbrtPlace& place) {
    needs_world(place, "AreaLightSource");
    state_.area_light = scene_.area_lights.size();
    scene_.area_lights.push_back(entity(type, std::move(parameters), place, "light"));
}

void PbrtState::add_light(const std::string& type, std::vector<PbrtParameter> parameters,
                          const PbrtPlace& place) {
    needs_world(place, "LightSource");
    scene_.lights.push_back({entity(type, std::move(parameters), place, "light"), state_.ctm});
}

void PbrtState::add_shape(const std::string& type, std::vector<PbrtParameter> parameters,
                          const PbrtPlace& place) {
    needs_world(place, "Shape");
    PbrtShape shape{entity(type, std::move(parameters), place, "shape"), state_.ctm,
                    state_.reverse_orientation, state_.material, state_.area_light};
    if (object_ && shape.area_light) {
        scene_.warn(place, "area lights do not shine in objects, as in pbrt");
        shape.area_light.reset();
    }
    auto& shapes = object_ ? scene_.objects[*object_] : scene_.shapes;
    shapes.push_back(std::move(shape));
}

void PbrtState::add_texture(const std::string& name, const std::string& value, const std::string& type,
                            std::vector<PbrtParameter> parameters, const PbrtPlace& place) {
    needs_world(place, "Texture");
    if (value != "float" && value != "spectrum")
        refuse_pbrt(place, "a texture of float or spectrum", quote(value));
    auto& textures = value == "float" ? scene_.float_textures : scene_.spectrum_textures;
    if (textures.contains(name))
        refuse_pbrt(place, fmt::format("a new name for the {} texture", value),
                    quote(name) + ", which exists");
    textures.emplace(name, PbrtTexture{entity(type, std::move(parameters), place, "texture"), state_.ctm});
}

void PbrtState::set_color_space(const PbrtToken& name) {
    const std::vector<std::string> names{"srgb", "dci-p3", "rec2020", "aces2065-1"};
    const auto it = std::ranges::find(names, name.text);
    if (it == names.end())
        refuse_pbrt(name.place, "the colour space " + one_of(names),
                    quote(name.text) + did_you_mean(name.text, names));
    state_.color_space = static_cast<PbrtColorSpace>(it - names.begin());
}

void PbrtState::reverse_orientation(const PbrtPlace& place) {
    needs_world(place, "ReverseOrientation");
    state_.reverse_orientation = !state_.reverse_orientation;
}

void PbrtState::ignore_media(const PbrtPlace& place) {
    scene_.warn(place, "participating media are not rendered");
}

PbrtGraphicsState PbrtState::begin_import(const PbrtPlace& place) const {
    needs_world(place, "Import");
    return state_;
}

PbrtScene PbrtState::finish(const PbrtPlace& end) {
    if (!in_world_) refuse_pbrt(end, "WorldBegin", "the end of the file");
    if (!stack_.empty())
        refuse_pbrt(end,
                    fmt::format("{} for the one at {}", stack_.back().object ? "ObjectEnd" : "AttributeEnd",
                                stack_.back().place.text()),
                    "the end of the file");
    return std::move(scene_);
}

}  // namespace relumine
