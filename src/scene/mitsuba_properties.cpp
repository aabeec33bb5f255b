// SPDX-License-Identifier: Apache-2.0
// Reading and checking the values of Mitsuba's objects.
#include "scene/mitsuba_properties.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == ','; }

double finite_number(std::string_view word, const PbrtPlace& place, std::string_view what) {
    if (word.size() > 1 && word[0] == '+') word.remove_prefix(1);
    double value = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc{} || stop != word.data() + word.size() || !(std::abs(value) < 1e38))
        refuse_pbrt(place, what, quote(word));
    return value;
}

}  // namespace

std::vector<double> mitsuba_numbers(const std::string& text, const PbrtPlace& place, std::string_view what) {
    std::vector<double> numbers;
    for (std::size_t i = 0; i < text.size();) {
        if (is_blank(text[i])) {
            ++i;
            continue;
        }
        std::size_t end = i;
        while (end < text.size() && !is_blank(text[end])) ++end;
        numbers.push_back(finite_number(std::string_view{text}.substr(i, end - i), place, what));
        i = end;
    }
    return numbers;
}

MitsubaProperties::MitsubaProperties(const MitsubaElement& object, MitsubaScene& scene)
    : object_(object), scene_(scene) {
    for (const auto& element : object.children) {
        Child child{element.get(), element->name, element->place};
        if (element->tag == "ref") {
            const std::string& id = element->attribute("id");
            const auto it = scene.document.by_id.find(id);
            if (it == scene.document.by_id.end()) {
                std::vector<std::string> ids;
                for (const auto& [known, target] : scene.document.by_id) ids.push_back(known);
                refuse_pbrt(element->place, "the id of an object", quote(id) + did_you_mean(id, ids));
            }
            child.element = it->second;
            if (child.name.empty()) child.name = child.element->name;
        }
        for (const Child& other : children_)
            if (!child.name.empty() && other.name == child.name)
                refuse_pbrt(child.place, fmt::format("{} once", quote(child.name)), "it twice");
        children_.push_back(std::move(child));
    }
}

MitsubaProperties::Child* MitsubaProperties::child(std::string_view name) {
    asked_.emplace_back(name);
    const auto it = std::ranges::find(children_, name, &Child::name);
    if (it == children_.end()) return nullptr;
    it->used = true;
    return &*it;
}

const MitsubaElement* MitsubaProperties::find(std::string_view name) {
    const Child* found = child(name);
    return found ? found->element : nullptr;
}

const MitsubaElement* MitsubaProperties::value(std::string_view name,
                                               std::initializer_list<std::string_view> tags) {
    const MitsubaElement* element = find(name);
    if (!element) return nullptr;
    if (std::ranges::find(tags, element->tag) == tags.end())
        refuse_pbrt(element->place, fmt::format("<{}> for {}", *tags.begin(), quote(name)),
                    fmt::format("<{}>", element->tag));
    return element;
}

double MitsubaProperties::number(std::string_view name, double otherwise) {
    const MitsubaElement* element = value(name, {"float", "integer"});
    if (!element) return otherwise;
    const std::string what = fmt::format("a number for {}", quote(name));
    const std::vector<double> numbers = mitsuba_numbers(element->attribute("value"), element->place, what);
    if (numbers.size() != 1) refuse_pbrt(element->place, what, fmt::format("{} numbers", numbers.size()));
    return numbers[0];
}

int MitsubaProperties::integer(std::string_view name, int otherwise) {
    const MitsubaElement* element = value(name, {"integer"});
    if (!element) return otherwise;
    const double x = number(name, 0);
    if (x != std::floor(x) || std::abs(x) > 2e9)
        refuse_pbrt(element->place, fmt::format("an integer for {}", quote(name)),
                    quote(element->attribute("value")));
    return static_cast<int>(x);
}

bool MitsubaProperties::boolean(std::string_view name, bool otherwise) {
    const MitsubaElement* element = value(name, {"boolean"});
    if (!element) return otherwise;
    const std::string& text = element->attribute("value");
    if (text == "true" || text == "True") return true;
    if (text != "false" && text != "False")
        refuse_pbrt(element->place, fmt::format("true or false for {}", quote(name)), quote(text));
    return false;
}

std::string MitsubaProperties::string(std::string_view name, const std::string& otherwise) {
    const MitsubaElement* element = value(name, {"string"});
    return element ? element->attribute("value") : otherwise;
}

std::string MitsubaProperties::choice(std::string_view name, const std::vector<std::string>& choices) {
    const std::string text = string(name, choices[0]);
    if (std::ranges::find(choices, text) == choices.end())
        refuse(name, one_of(choices) + " for " + quote(name), quote(text) + did_you_mean(text, choices));
    return text;
}

std::array<double, 3> MitsubaProperties::vector(std::string_view name, std::array<double, 3> otherwise) {
    const MitsubaElement* element = value(name, {"point", "vector"});
    if (!element) return otherwise;
    const std::string what = fmt::format("three numbers for {}", quote(name));
    std::vector<double> numbers;
    if (element->attributes.contains("value")) {
        numbers = mitsuba_numbers(element->attribute("value"), element->place, what);
    } else {
        for (const char* axis : {"x", "y", "z"})
            for (const double x : mitsuba_numbers(element->attribute(axis), element->place, what))
                numbers.push_back(x);
    }
    if (numbers.size() != 3) refuse_pbrt(element->place, what, fmt::format("{}", numbers.size()));
    return {numbers[0], numbers[1], numbers[2]};
}

Transform MitsubaProperties::transform(std::string_view name) {
    const MitsubaElement* element = value(name, {"transform"});
    return element ? mitsuba_transform(*element) : Transform{};
}

std::vector<const MitsubaElement*> MitsubaProperties::objects(std::string_view tag) {
    std::vector<const MitsubaElement*> found;
    for (Child& child : children_) {
        if (child.element->tag != tag) continue;
        child.used = true;
        found.push_back(child.element);
    }
    return found;
}

void MitsubaProperties::ignore(std::initializer_list<std::string_view> names) {
    for (const std::string_view name : names) (void)child(name);
}

void MitsubaProperties::unsupported(std::initializer_list<std::string_view> names, std::string_view instead) {
    for (const std::string_view name : names)
        if (const Child* found = child(name))
            scene_.notes.warn(found->place, fmt::format("{} of {} is not supported: {}", quote(name),
                                                        quote(object_.type), instead));
}

void MitsubaProperties::finish() {
    for (Child& child : children_) {
        if (child.used) continue;
        child.used = true;
        const std::string what =
            child.name.empty() ? fmt::format("<{}>", child.element->tag) : quote(child.name);
        scene_.notes.warn(child.place, fmt::format("{} of {} is unknown and was not read{}", what,
                                                   quote(object_.type), did_you_mean(child.name, asked_)));
    }
}

void MitsubaProperties::warn(const std::string& text) { scene_.notes.warn(object_.place, text); }

void MitsubaProperties::refuse(std::string_view name, const std::string& expected,
                               const std::string& found) const {
    const auto it = std::ranges::find(children_, name, &Child::name);
    refuse_pbrt(it == children_.end() ? object_.place : it->place, expected, found);
}

}  // namespace relumine
