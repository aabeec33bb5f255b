// SPDX-License-Identifier: Apache-2.0
// What one object of a Mitsuba scene says about itself: its values, nested objects and references.
#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/transform.hpp"
#include "scene/mitsuba_document.hpp"
#include "scene/pbrt_scene.hpp"

namespace relumine {

/// The document, its files, and what was warned of.
struct MitsubaScene {
    MitsubaDocument document;
    PbrtFiles& files;
    PbrtScene notes;  // its warnings alone are used
};

/// One object's children by name. Those that nobody asks for are warned of at the end.
class MitsubaProperties {
  public:
    MitsubaProperties(const MitsubaElement& object, MitsubaScene& scene);

    [[nodiscard]] double number(std::string_view name, double otherwise);
    [[nodiscard]] int integer(std::string_view name, int otherwise);
    [[nodiscard]] bool boolean(std::string_view name, bool otherwise);
    [[nodiscard]] std::string string(std::string_view name, const std::string& otherwise);
    [[nodiscard]] std::array<double, 3> vector(std::string_view name, std::array<double, 3> otherwise);
    [[nodiscard]] Transform transform(std::string_view name);
    /// One of `choices`, the first of which is taken where none is given.
    [[nodiscard]] std::string choice(std::string_view name, const std::vector<std::string>& choices);

    /// The child of that name with references followed, or null; counts as used.
    [[nodiscard]] const MitsubaElement* find(std::string_view name);
    /// All objects of that tag ("bsdf"), references followed; they count as used.
    [[nodiscard]] std::vector<const MitsubaElement*> objects(std::string_view tag);

    /// Known, and without effect on the picture.
    void ignore(std::initializer_list<std::string_view> names);
    /// Known, but not done: warns where it is given.
    void unsupported(std::initializer_list<std::string_view> names, std::string_view instead);
    /// Warns of everything that nobody asked for.
    void finish();

    void warn(const std::string& text);
    [[noreturn]] void refuse(std::string_view name, const std::string& expected,
                             const std::string& found) const;
    [[nodiscard]] const MitsubaElement& object() const { return object_; }
    [[nodiscard]] MitsubaScene& scene() { return scene_; }

  private:
    struct Child {
        const MitsubaElement* element;  // behind references
        std::string name;
        PbrtPlace place;
        bool used = false;
    };
    [[nodiscard]] Child* child(std::string_view name);
    [[nodiscard]] const MitsubaElement* value(std::string_view name,
                                              std::initializer_list<std::string_view> tags);

    const MitsubaElement& object_;
    MitsubaScene& scene_;
    std::vector<Child> children_;
    std::vector<std::string> asked_;
};

/// Finite numbers between blanks or commas. Throws SceneError with `what` expected.
[[nodiscard]] std::vector<double> mitsuba_numbers(const std::string& text, const PbrtPlace& place,
                                                  std::string_view what);

/// Of a <transform>; its steps act in order, each on what the ones before it gave.
[[nodiscard]] Transform mitsuba_transform(const MitsubaElement& element);

/// The axes s and t that Mitsuba completes a unit vector to a frame with.
[[nodiscard]] std::array<std::array<double, 3>, 2> mitsuba_frame(const std::array<double, 3>& n);

}  // namespace relumine
