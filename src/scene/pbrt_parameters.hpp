// SPDX-License-Identifier: Apache-2.0
// The parameter list behind a pbrt directive: typed values, looked up by name, all of them used.
#pragma once

#include <array>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "base/vec.hpp"
#include "scene/pbrt_tokenizer.hpp"

namespace relumine {

/// The primaries that "rgb" values are meant in.
enum class PbrtColorSpace { srgb, dci_p3, rec2020, aces2065 };

/// One `"type name" values`.
struct PbrtParameter {
    std::string type, name;
    PbrtPlace place;
    std::vector<double> numbers;       // of integer, float, point…, rgb, blackbody; finite
    std::vector<std::string> strings;  // of string, texture, spectrum
    std::vector<bool> booleans;
    PbrtColorSpace color_space = PbrtColorSpace::srgb;
    bool optional = false;  // from an Attribute directive: need not be used
};

/// Checks type and number of values. Throws SceneError.
void check_pbrt_parameter(const PbrtParameter& parameter);

/// The parameters of one directive. A name may be given once per type; those of `Attribute` come last and
/// count where the directive itself is silent. Wrong types and counts throw SceneError.
class PbrtParameters {
  public:
    PbrtParameters() = default;
    PbrtParameters(std::string owner, PbrtPlace place, std::vector<PbrtParameter> own,
                   std::span<const PbrtParameter> attributes = {});

    [[nodiscard]] double number(std::string_view name, double otherwise) const;
    [[nodiscard]] int integer(std::string_view name, int otherwise) const;
    [[nodiscard]] bool boolean(std::string_view name, bool otherwise) const;
    [[nodiscard]] std::string string(std::string_view name, const std::string& otherwise) const;
    [[nodiscard]] std::array<double, 3> point(std::string_view name, std::array<double, 3> otherwise) const;
    [[nodiscard]] std::array<double, 3> vector(std::string_view name, std::array<double, 3> otherwise) const;

    /// All values of a parameter of this type; empty where there is none.
    [[nodiscard]] std::vector<double> numbers(std::string_view type, std::string_view name) const;
    [[nodiscard]] std::vector<std::string> strings(std::string_view name) const;
    [[nodiscard]] std::vector<Vec3> vectors(std::string_view type, std::string_view name) const;
    [[nodiscard]] std::vector<Vec2> points2(std::string_view name) const;
    [[nodiscard]] std::vector<std::uint32_t> indices(std::string_view name) const;

    /// The parameter of this type, or null; counts as used.
    [[nodiscard]] const PbrtParameter* find(std::string_view type, std::string_view name) const;
    /// The spectrum of that name (rgb, blackbody or spectrum), or null.
    [[nodiscard]] const PbrtParameter* find_spectrum(std::string_view name) const;
    /// The name of the texture given for `name`, or null.
    [[nodiscard]] const PbrtParameter* find_texture(std::string_view name) const;

    /// Marks as known and used without looking at it.
    void ignore(std::initializer_list<std::string_view> names) const;
    /// Whether a parameter of that name is there, of whatever type.
    [[nodiscard]] bool has(std::string_view name) const;
    /// Throws SceneError for the first parameter that nobody asked for, with the nearest name.
    void finish() const;

    /// Equal for equal parameters.
    [[nodiscard]] std::string fingerprint() const;

    [[nodiscard]] const PbrtPlace& place() const { return place_; }
    [[nodiscard]] const std::string& owner() const { return owner_; }
    /// Throws SceneError at the parameter's place, or the directive's where it is not there.
    [[noreturn]] void refuse(std::string_view name, const std::string& expected,
                             const std::string& found) const;

  private:
    std::string owner_;  // "sphere", for messages
    PbrtPlace place_;
    std::vector<PbrtParameter> parameters_;
    mutable std::set<std::string, std::less<>> used_;  // "type name"
    mutable std::set<std::string, std::less<>> asked_;
};

}  // namespace relumine
