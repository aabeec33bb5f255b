// SPDX-License-Identifier: Apache-2.0
// Mitsuba's colours: rgb, spectra by wavelength, black bodies; named metals and glasses.
#include "scene/mitsuba_spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "image/srgb.hpp"
#include "scene/pbrt_spectrum.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using Use = MitsubaColorUse;

Spectrum constant_spectrum(double value, Use use) {
    const auto v = static_cast<float>(value);
    if (use != Use::light) return Spectrum{v};
    const std::array<double, 4> everywhere{300, 1, 900, 1};
    return light_rgb_of_samples(everywhere) * v;
}

Spectrum of_pairs(const std::vector<double>& pairs, Use use, const PbrtPlace& place) {
    if (pairs.size() < 4 || pairs.size() % 2 != 0)
        refuse_pbrt(place, "two or more pairs of wavelength and value",
                    fmt::format("{} numbers", pairs.size()));
    for (std::size_t i = 2; i < pairs.size(); i += 2)
        if (!(pairs[i] > pairs[i - 2]))
            refuse_pbrt(place, "increasing wavelengths",
                        fmt::format("{:g} after {:g}", pairs[i], pairs[i - 2]));
    if (use == Use::light) return light_rgb_of_samples(pairs);
    return rgb_of_samples(pairs, PbrtSpectrumUse::unbounded);
}

/// "400:0.1, 700:0.9", one number, or the numbers of a file.
Spectrum of_text(const MitsubaElement& e, Use use, MitsubaScene& scene) {
    if (e.attributes.contains("filename")) {
        const std::vector<std::uint8_t> bytes = scene.files.read(e.attribute("filename"), e.place);
        std::string text;
        bool comment = false;
        for (const std::uint8_t byte : bytes) {
            comment = byte == '#' || (comment && byte != '\n');
            if (!comment) text += static_cast<char>(byte);
        }
        return of_pairs(mitsuba_numbers(text, e.place,
                                        "pairs of wavelength and value in " + quote(e.attribute("filename"))),
                        use, e.place);
    }
    std::string text = e.attribute("value");
    const std::string what = "a number or pairs wavelength:value";
    const bool paired = text.find(':') != text.npos;
    std::ranges::replace(text, ':', ' ');
    const std::vector<double> numbers = mitsuba_numbers(text, e.place, what);
    if (paired) return of_pairs(numbers, use, e.place);
    if (numbers.size() != 1) refuse_pbrt(e.place, what, quote(e.attribute("value")));
    return constant_spectrum(numbers[0], use);
}

Spectrum of_rgb(const MitsubaElement& e, bool encoded) {
    const std::vector<double> v =
        mitsuba_numbers(e.attribute("value"), e.place, "three numbers for the colour");
    if (v.size() != 3 && v.size() != 1)
        refuse_pbrt(e.place, "three numbers for the colour", fmt::format("{}", v.size()));
    std::array<float, 3> c{};
    for (std::size_t i = 0; i < 3; ++i) {
        const double x = v[v.size() == 3 ? i : 0];
        c[i] = static_cast<float>(encoded ? linear_from_srgb(std::clamp(x, 0.0, 1.0)) : x);
    }
    return {c[0], c[1], c[2]};
}

Spectrum black_body(double kelvin, double scale, const PbrtPlace& place) {
    if (!(kelvin >= 100 && kelvin <= 1e6))
        refuse_pbrt(place, "a temperature of 100 to 1000000 K", fmt::format("{:g}", kelvin));
    return blackbody_radiance_rgb(kelvin) * static_cast<float>(scale);
}

/// <spectrum type="…"> with values of its own.
Spectrum of_plugin(const MitsubaElement& e, Use use, MitsubaScene& scene) {
    MitsubaProperties p(e, scene);
    const std::vector<std::string> types{"blackbody", "d65", "irregular", "srgb", "uniform"};
    Spectrum color;
    if (e.type == "uniform") {
        color = constant_spectrum(p.number("value", 1), use);
    } else if (e.type == "d65") {
        color =
            mitsuba_color(p, "color", Spectrum{1}, Use::unbounded) * static_cast<float>(p.number("scale", 1));
    } else if (e.type == "srgb") {
        color = mitsuba_color(p, "color", Spectrum{1}, Use::unbounded);
    } else if (e.type == "blackbody") {
        color = black_body(p.number("temperature", 5000), p.number("scale", 1), e.place);
    } else if (e.type == "irregular") {
        const auto a = mitsuba_numbers(p.string("wavelengths", ""), e.place, "numbers for the wavelengths");
        const auto b = mitsuba_numbers(p.string("values", ""), e.place, "numbers for the values");
        if (a.size() != b.size())
            p.refuse("values", fmt::format("{} values", a.size()), fmt::format("{}", b.size()));
        std::vector<double> pairs;
        for (std::size_t i = 0; i < a.size(); ++i) pairs.insert(pairs.end(), {a[i], b[i]});
        color = of_pairs(pairs, use, e.place);
    } else {
        refuse_pbrt(e.place, "a spectrum among " + one_of(types),
                    quote(e.type) + did_you_mean(e.type, types));
    }
    p.finish();
    return color;
}

Spectrum read(const MitsubaElement& e, Use use, MitsubaScene& scene) {
    if (e.tag == "rgb") return of_rgb(e, false);
    if (e.tag == "srgb") return of_rgb(e, true);
    if (e.tag == "spectrum") return e.type.empty() ? of_text(e, use, scene) : of_plugin(e, use, scene);
    if (e.tag == "blackbody") {
        const auto kelvin = mitsuba_numbers(e.attribute("temperature"), e.place, "a temperature in K");
        const auto scale = mitsuba_numbers(e.attribute("scale"), e.place, "a scale");
        if (kelvin.size() != 1 || scale.size() > 1)
            refuse_pbrt(e.place, "a temperature in K", quote(e.attribute("temperature")));
        return black_body(kelvin[0], scale.empty() ? 1 : scale[0], e.place);
    }
    if (e.tag != "float" && e.tag != "integer")
        refuse_pbrt(e.place, fmt::format("a colour or spectrum for {}", quote(e.name)),
                    fmt::format("<{}{}>", e.tag, e.type.empty() ? "" : " type=" + quote(e.type)));
    const auto v =
        mitsuba_numbers(e.attribute("value"), e.place, fmt::format("a number for {}", quote(e.name)));
    if (v.size() != 1)
        refuse_pbrt(e.place, fmt::format("a number for {}", quote(e.name)),
                    fmt::format("{} numbers", v.size()));
    return Spectrum{static_cast<float>(v[0])};
}

struct NamedColor {
    std::string_view name;
    Spectrum f0;
};
const std::vector<NamedColor> metals{
    {"none", {1, 1, 1}},
    {"a-C", {0.2118f, 0.2120f, 0.1999f}},
    {"Ag", {0.9721f, 0.9598f, 0.9153f}},
    {"Al", {0.9137f, 0.9213f, 0.9244f}},
    {"AlAs", {0.2803f, 0.2665f, 0.4310f}},
    {"Au", {1.0000f, 0.7821f, 0.3435f}},
    {"Be", {0.5394f, 0.5378f, 0.5370f}},
    {"Cr", {0.6351f, 0.6621f, 0.7046f}},
    {"Cu", {0.9556f, 0.6376f, 0.5382f}},
    {"Cu2O", {0.2432f, 0.2648f, 0.2730f}},
    {"CuO", {0.2211f, 0.2168f, 0.2157f}},
    {"Hg", {0.7819f, 0.7794f, 0.7784f}},
    {"HgTe", {0.4050f, 0.3841f, 0.3852f}},
    {"Ir", {0.7012f, 0.6930f, 0.6565f}},
    {"K", {0.9502f, 0.9373f, 0.9207f}},
    {"Mo", {0.5589f, 0.5790f, 0.5704f}},
    {"Na_palik", {0.9776f, 0.9610f, 0.9362f}},
    {"Nb", {0.5041f, 0.5069f, 0.5049f}},
    {"Ni_palik", {0.6597f, 0.6085f, 0.5258f}},
    {"Rh", {0.7975f, 0.7644f, 0.7425f}},
    {"SiC", {0.2018f, 0.2063f, 0.2144f}},
    {"Ta", {0.3894f, 0.3603f, 0.4122f}},
    {"Te", {0.5727f, 0.5931f, 0.5843f}},
    {"TiC", {0.4892f, 0.4579f, 0.4450f}},
    {"TiN", {0.6141f, 0.4614f, 0.2328f}},
    {"TiO2", {0.2324f, 0.2446f, 0.2726f}},
    {"VC", {0.4698f, 0.4363f, 0.4141f}},
    {"V_palik", {0.5114f, 0.5277f, 0.5651f}},
    {"VN", {0.4697f, 0.4100f, 0.3451f}},
    {"W", {0.5156f, 0.4959f, 0.4676f}},
};

struct NamedIor {
    std::string_view name;
    double ior;
};
constexpr std::array<NamedIor, 22> iors{{
    {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
    {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
    {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
    {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
    {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
    {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
    {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"pet", 1.5750},
    {"diamond", 2.419},
}};

}  // namespace

Spectrum mitsuba_color(const MitsubaElement& e, Use use, MitsubaScene& scene) {
    Spectrum c = read(e, use, scene);
    if (c.r < 0 || c.g < 0 || c.b < 0)
        refuse_pbrt(e.place, fmt::format("values of at least 0 for {}", quote(e.name)),
                    fmt::format("{:g} {:g} {:g}", c.r, c.g, c.b));
    if (use != Use::albedo || max_component(c) <= 1) return c;
    if (max_component(c) > 1.0001f)
        scene.notes.warn(e.place, fmt::format("{} above 1 is read as 1", quote(e.name)));
    return {std::min(c.r, 1.0f), std::min(c.g, 1.0f), std::min(c.b, 1.0f)};
}

Spectrum mitsuba_color(MitsubaProperties& p, std::string_view name, Spectrum otherwise, Use use) {
    const MitsubaElement* element = p.find(name);
    return element ? mitsuba_color(*element, use, p.scene()) : otherwise;
}

std::optional<Spectrum> mitsuba_metal(const std::string& name) {
    for (const NamedColor& metal : metals)
        if (metal.name == name) return metal.f0;
    return {};
}

std::vector<std::string> mitsuba_metal_names() {
    std::vector<std::string> names;
    for (const NamedColor& metal : metals) names.emplace_back(metal.name);
    return names;
}

std::optional<double> mitsuba_ior(const std::string& name) {
    for (const NamedIor& entry : iors)
        if (entry.name == name) return entry.ior;
    return {};
}

std::vector<std::string> mitsuba_ior_names() {
    std::vector<std::string> names;
    for (const NamedIor& entry : iors) names.emplace_back(entry.name);
    return names;
}

}  // namespace relumine
