// SPDX-License-Identifier: Apache-2.0
// The parameter list behind a pbrt directive.
#include "scene/pbrt_parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

/// How many numbers make one value; 0 for types that are not numbers.
struct NumericType {
    std::string_view name;
    std::size_t size;
};
constexpr std::array<NumericType, 9> numeric_types{{{"integer", 1},
                                                    {"float", 1},
                                                    {"point2", 2},
                                                    {"vector2", 2},
                                                    {"point3", 3},
                                                    {"vector3", 3},
                                                    {"normal", 3},
                                                    {"rgb", 3},
                                                    {"blackbody", 1}}};
const std::vector<std::string> other_types{"bool", "string", "texture", "spectrum"};

/// Names that pbrt-v3 used, and what they are called now.
constexpr std::array<std::pair<std::string_view, std::string_view>, 6> old_types{{{"point", "point3"},
                                                                                  {"vector", "vector3"},
                                                                                  {"normal3", "normal"},
                                                                                  {"color", "rgb"},
                                                                                  {"int", "integer"},
                                                                                  {"boolean", "bool"}}};

[[noreturn]] void refuse_type(const PbrtParameter& p) {
    for (const auto& [old, now] : old_types)
        if (p.type == old)
            refuse_pbrt(p.place, "a parameter type of pbrt-v4",
                        fmt::format("{} (now called \"{}\")", quote(p.type), now));
    std::vector<std::string> all = other_types;
    for (const NumericType& type : numeric_types) all.emplace_back(type.name);
    refuse_pbrt(p.place, "the type " + one_of(all), quote(p.type) + did_you_mean(p.type, all));
}

void check_numbers(const PbrtParameter& p, std::size_t size) {
    const std::string label = fmt::format("{} values for {}", p.type, quote(p.name));
    if (!p.strings.empty()) refuse_pbrt(p.place, label, "the string " + quote(p.strings.front()));
    if (!p.booleans.empty()) refuse_pbrt(p.place, label, p.booleans.front() ? "true" : "false");
    if (p.numbers.empty()) refuse_pbrt(p.place, label, "none");
    if (p.numbers.size() % size != 0)
        refuse_pbrt(p.place, fmt::format("a multiple of {} numbers for {}", size, quote(p.name)),
                    fmt::format("{}", p.numbers.size()));
    if (p.type != "integer") return;
    for (const double x : p.numbers)
        if (x != std::floor(x) || std::abs(x) > std::numeric_limits<int>::max())
            refuse_pbrt(p.place, label, fmt::format("{:g}", x));
}

void check_strings(const PbrtParameter& p) {
    const std::string label = fmt::format("a string in quotation marks for {}", quote(p.name));
    if (!p.numbers.empty()) refuse_pbrt(p.place, label, fmt::format("{:g}", p.numbers.front()));
    if (!p.booleans.empty()) refuse_pbrt(p.place, label, p.booleans.front() ? "true" : "false");
    if (p.strings.empty()) refuse_pbrt(p.place, label, "none");
}

void check_booleans(const PbrtParameter& p) {
    const std::string label = fmt::format("true or false for {}", quote(p.name));
    if (!p.strings.empty())
        refuse_pbrt(p.place, label + ", without quotation marks", "the string " + quote(p.strings.front()));
    if (!p.numbers.empty()) refuse_pbrt(p.place, label, fmt::format("{:g}", p.numbers.front()));
    if (p.booleans.empty()) refuse_pbrt(p.place, label, "none");
}

}  // namespace

void check_pbrt_parameter(const PbrtParameter& p) {
    for (const NumericType& type : numeric_types)
        if (p.type == type.name) return check_numbers(p, type.size);
    if (p.type == "bool") return check_booleans(p);
    if (p.type == "string" || p.type == "texture") return check_strings(p);
    if (p.type != "spectrum") refuse_type(p);
    if (p.numbers.empty()) return check_strings(p);
    if (!p.strings.empty() || p.numbers.size() % 2 != 0)
        refuse_pbrt(p.place, fmt::format("pairs of wavelength and value for {}", quote(p.name)),
                    fmt::format("{} numbers and {} strings", p.numbers.size(), p.strings.size()));
}

PbrtParameters::PbrtParameters(std::string owner, PbrtPlace place, std::vector<PbrtParameter> own,
                               std::span<const PbrtParameter> attributes)
    : owner_(std::move(owner)), place_(std::move(place)), parameters_(std::move(own)) {
    for (std::size_t i = 0; i < parameters_.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            if (parameters_[i].name == parameters_[j].name && parameters_[i].type == parameters_[j].type)
                refuse_pbrt(parameters_[i].place, "each parameter once",
                            quote(parameters_[i].name) + " again");
    for (auto it = attributes.rbegin(); it != attributes.rend(); ++it) {  // the last one counts
        const bool given = std::ranges::any_of(
            parameters_, [&](const PbrtParameter& p) { return p.name == it->name && p.type == it->type; });
        if (!given) parameters_.push_back(*it);
    }
}

const PbrtParameter* PbrtParameters::find(std::string_view type, std::string_view name) const {
    asked_.emplace(name);
    for (const PbrtParameter& p : parameters_) {
        if (p.name != name || p.type != type) continue;
        used_.insert(p.type + ' ' + p.name);
        return &p;
    }
    return nullptr;
}

namespace {

const PbrtParameter* single(const PbrtParameter* p, std::size_t values, std::size_t found) {
    if (p && found != values)
        refuse_pbrt(p->place,
                    fmt::format("{} value{} for {}", values, values == 1 ? "" : "s", quote(p->name)),
                    fmt::format("{}", found));
    return p;
}
const PbrtParameter* single_number(const PbrtParameter* p, std::size_t values = 1) {
    return p ? single(p, values, p->numbers.size()) : p;
}

std::array<double, 3> triple(const PbrtParameter* p, std::array<double, 3> otherwise) {
    return single_number(p, 3) ? std::array{p->numbers[0], p->numbers[1], p->numbers[2]} : otherwise;
}

}  // namespace

double PbrtParameters::number(std::string_view name, double otherwise) const {
    const PbrtParameter* p = single_number(find("float", name));
    return p ? p->numbers[0] : otherwise;
}
int PbrtParameters::integer(std::string_view name, int otherwise) const {
    const PbrtParameter* p = single_number(find("integer", name));
    return p ? static_cast<int>(p->numbers[0]) : otherwise;
}
bool PbrtParameters::boolean(std::string_view name, bool otherwise) const {
    const PbrtParameter* p = find("bool", name);
    if (p) single(p, 1, p->booleans.size());
    return p ? p->booleans[0] : otherwise;
}
std::string PbrtParameters::string(std::string_view name, const std::string& otherwise) const {
    const PbrtParameter* p = find("string", name);
    if (p) single(p, 1, p->strings.size());
    return p ? p->strings[0] : otherwise;
}
std::array<double, 3> PbrtParameters::point(std::string_view name, std::array<double, 3> otherwise) const {
    return triple(find("point3", name), otherwise);
}
std::array<double, 3> PbrtParameters::vector(std::string_view name, std::array<double, 3> otherwise) const {
    return triple(find("vector3", name), otherwise);
}

std::vector<double> PbrtParameters::numbers(std::string_view type, std::string_view name) const {
    const PbrtParameter* p = find(type, name);
    return p ? p->numbers : std::vector<double>{};
}
std::vector<std::string> PbrtParameters::strings(std::string_view name) const {
    const PbrtParameter* p = find("string", name);
    return p ? p->strings : std::vector<std::string>{};
}

std::vector<Vec3> PbrtParameters::vectors(std::string_view type, std::string_view name) const {
    const PbrtParameter* p = find(type, name);
    std::vector<Vec3> values;
    if (!p) return values;
    values.reserve(p->numbers.size() / 3);
    const auto f = [&](std::size_t i) { return static_cast<float>(p->numbers[i]); };
    for (std::size_t i = 0; i + 2 < p->numbers.size(); i += 3) values.push_back({f(i), f(i + 1), f(i + 2)});
    return values;
}

std::vector<Vec2> PbrtParameters::points2(std::string_view name) const {
    const PbrtParameter* p = find("point2", name);
    std::vector<Vec2> values;
    if (!p) return values;
    values.reserve(p->numbers.size() / 2);
    for (std::size_t i = 0; i + 1 < p->numbers.size(); i += 2)
        values.push_back({static_cast<float>(p->numbers[i]), static_cast<float>(p->numbers[i + 1])});
    return values;
}

std::vector<std::uint32_t> PbrtParameters::indices(std::string_view name) const {
    const PbrtParameter* p = find("integer", name);
    std::vector<std::uint32_t> values;
    if (!p) return values;
    values.reserve(p->numbers.size());
    for (const double x : p->numbers) {
        if (x < 0) refuse(name, "indices of at least 0", fmt::format("{:g}", x));
        values.push_back(static_cast<std::uint32_t>(x));
    }
    return values;
}

const PbrtParameter* PbrtParameters::find_spectrum(std::string_view name) const {
    for (const std::string_view type : {"rgb", "blackbody", "spectrum"}) {
        const PbrtParameter* p = find(type, name);
        if (!p) continue;
        if (type == "rgb") return single_number(p, 3);
        if (type == "blackbody") return single_number(p, 1);
        return p->numbers.empty() ? single(p, 1, p->strings.size()) : p;
    }
    return nullptr;
}

const PbrtParameter* PbrtParameters::find_texture(std::string_view name) const {
    const PbrtParameter* p = find("texture", name);
    return p ? single(p, 1, p->strings.size()) : nullptr;
}

void PbrtParameters::ignore(std::initializer_list<std::string_view> names) const {
    for (const std::string_view name : names) {
        asked_.emplace(name);
        for (const PbrtParameter& p : parameters_)
            if (p.name == name) used_.insert(p.type + ' ' + p.name);
    }
}

bool PbrtParameters::has(std::string_view name) const {
    return std::ranges::any_of(parameters_, [&](const PbrtParameter& p) { return p.name == name; });
}

std::string PbrtParameters::fingerprint() const {
    std::string text;
    for (const PbrtParameter& p : parameters_) {
        text += fmt::format("{} {}", p.type, p.name);
        for (const double x : p.numbers) text += fmt::format(" {}", x);
        for (const std::string& s : p.strings) text += ' ' + s;
        for (const bool b : p.booleans) text += b ? " true" : " false";
        text += '\n';
    }
    return text;
}

void PbrtParameters::finish() const {
    for (const PbrtParameter& p : parameters_) {
        if (p.optional || used_.contains(p.type + ' ' + p.name)) continue;
        if (asked_.contains(p.name))
            refuse_pbrt(p.place, fmt::format("{} of {} in another type", quote(p.name), quote(owner_)),
                        quote(p.type));
        const std::vector<std::string> known(asked_.begin(), asked_.end());
        refuse_pbrt(p.place, fmt::format("a parameter that {} has", quote(owner_)),
                    quote(p.name) + did_you_mean(p.name, known));
    }
}

void PbrtParameters::refuse(std::string_view name, const std::string& expected,
                            const std::string& found) const {
    for (const PbrtParameter& p : parameters_)
        if (p.name == name) refuse_pbrt(p.place, fmt::format("{} for {}", expected, quote(name)), found);
    refuse_pbrt(place_, fmt::format("{} {} for {}", quote(owner_), expected, quote(name)), found);
}

}  // namespace relumine
