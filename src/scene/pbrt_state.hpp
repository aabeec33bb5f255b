// SPDX-License-Identifier: Apache-2.0
// pbrt's graphics state: what the directives change and what they add to the scene.
#pragma once

#include "scene/pbrt_scene.hpp"
#include "scene/pbrt_transform.hpp"

namespace relumine {

/// What AttributeBegin saves and AttributeEnd brings back.
struct PbrtGraphicsState {
    Transform ctm;
    bool transforms_active = true;  // false between ActiveTransform EndTime and the next: motion is not read
    bool reverse_orientation = false;
    PbrtColorSpace color_space = PbrtColorSpace::srgb;
    PbrtMaterialRef material;
    std::optional<std::size_t> area_light;
    std::map<std::string, std::vector<PbrtParameter>> attributes;  // by target: shape, light, …
};

/// One method per directive. All throw SceneError with the place of the directive.
class PbrtState {
  public:
    PbrtState();

    void begin_world(const PbrtPlace& place);
    void push(const PbrtPlace& place);
    void pop(const PbrtPlace& place);
    void begin_object(const std::string& name, const PbrtPlace& place);
    void end_object(const PbrtPlace& place);
    void add_instance(const std::string& name, const PbrtPlace& place);

    /// ctm = ctm * transform.
    void concat(const Transform& transform);
    void set_transform(const Transform& transform);
    void name_transform(const std::string& name);
    void use_named_transform(const std::string& name, const PbrtPlace& place);
    void set_active_transform(const PbrtToken& which);

    /// Camera, Film, Integrator, Sampler and so on: before WorldBegin.
    void set_option(const std::string& directive, const std::string& type,
                    std::vector<PbrtParameter> parameters, const PbrtPlace& place);
    void set_attribute(const std::string& target, std::vector<PbrtParameter> parameters,
                       const PbrtPlace& place);
    void set_material(const std::string& type, std::vector<PbrtParameter> parameters, const PbrtPlace& place);
    void make_named_material(const std::string& name, std::vector<PbrtParameter> parameters,
                             const PbrtPlace& place);
    void use_named_material(const std::string& name, const PbrtPlace& place);
    void set_area_light(const std::string& type, std::vector<PbrtParameter> parameters,
                        const PbrtPlace& place);
    void add_light(const std::string& type, std::vector<PbrtParameter> parameters, const PbrtPlace& place);
    void add_shape(const std::string& type, std::vector<PbrtParameter> parameters, const PbrtPlace& place);
    void add_texture(const std::string& name, const std::string& value, const std::string& type,
                     std::vector<PbrtParameter> parameters, const PbrtPlace& place);
    void set_color_space(const PbrtToken& name);
    void reverse_orientation(const PbrtPlace& place);
    void ignore_media(const PbrtPlace& place);

    /// Import: everything but the state is kept.
    [[nodiscard]] PbrtGraphicsState begin_import(const PbrtPlace& place) const;
    void end_import(PbrtGraphicsState state) { state_ = std::move(state); }
    [[nodiscard]] std::size_t depth() const { return stack_.size(); }

    [[nodiscard]] PbrtColorSpace color_space() const { return state_.color_space; }
    /// Checks that all is closed, and gives the scene away.
    [[nodiscard]] PbrtScene finish(const PbrtPlace& end);
    [[nodiscard]] PbrtScene& scene() { return scene_; }

  private:
    struct Saved {
        PbrtGraphicsState state;
        PbrtPlace place;
        bool object = false;
    };
    void needs_world(const PbrtPlace& place, std::string_view directive) const;
    void needs_options(const PbrtPlace& place, std::string_view directive) const;
    [[nodiscard]] PbrtEntity entity(const std::string& type, std::vector<PbrtParameter> parameters,
                                    const PbrtPlace& place, const std::string& target = "") const;

    PbrtScene scene_;
    PbrtGraphicsState state_;
    std::vector<Saved> stack_;
    std::map<std::string, Transform> named_transforms_;
    std::optional<std::string> object_;  // between ObjectBegin and ObjectEnd
    bool in_world_ = false;
};

}  // namespace relumine
