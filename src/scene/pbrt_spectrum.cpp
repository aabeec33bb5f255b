// SPDX-License-Identifier: Apache-2.0
// pbrt's spectra reduced to linear Rec. 709 RGB.
#include "scene/pbrt_spectrum.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

#include "base/message.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

using Triple = std::array<double, 3>;

constexpr int first_nm = 380, last_nm = 780, step_nm = 10;
constexpr std::size_t table_size = (last_nm - first_nm) / step_nm + 1;

// CIE 1931 2° standard observer and standard illuminant D65, every 10 nm from 380 nm [CIE15].
constexpr std::array<double, table_size> cie_x{
    .001368, .004243, .01431, .04351, .13438,  .2839,   .34828,  .3362,  .2908,  .19536, .09564,
    .03201,  .0049,   .0093,  .06327, .1655,   .2904,   .43345,  .5945,  .7621,  .9163,  1.0263,
    1.0622,  1.0026,  .85445, .6424,  .4479,   .2835,   .1649,   .0874,  .04677, .0227,  .011359,
    .00579,  .002899, .00144, .00069, .000332, .000166, .000083, .000042};
constexpr std::array<double, table_size> cie_y{
    .000039, .00012,  .000396, .00121,  .004,   .0116,  .023,   .038,   .06,  .09098, .13902,
    .20802,  .323,    .503,    .71,     .862,   .954,   .99495, .995,   .952, .87,    .757,
    .631,    .503,    .381,    .265,    .175,   .107,   .061,   .032,   .017, .00821, .004102,
    .002091, .001047, .00052,  .000249, .00012, .00006, .00003, .000015};
constexpr std::array<double, table_size> cie_z{.00645,  .02005, .06785,  .2074,  .6456,  1.3856, 1.74706,
                                               1.77211, 1.6692, 1.28764, .81295, .46518, .272,   .1582,
                                               .07825,  .04216, .0203,   .00875, .0039,  .0021,  .00165,
                                               .0011,   .0008,  .00034,  .00019, .00005, .00002};
constexpr std::array<double, table_size> cie_d65{
    49.9755, 54.6482, 82.7549, 91.486,  93.4318, 86.6823, 104.865, 117.008, 117.812, 114.861, 115.923,
    108.811, 109.354, 107.802, 104.79,  107.689, 104.405, 104.046, 100,     96.3342, 95.788,  88.6856,
    90.0062, 89.5991, 87.6987, 83.2886, 83.6992, 80.0268, 80.2146, 82.2778, 78.2842, 69.7213, 71.6091,
    74.349,  61.604,  69.8856, 75.087,  63.5927, 46.4182, 66.8054, 63.3828};

double at(const std::array<double, table_size>& table, double nm) {
    const double t = std::clamp((nm - first_nm) / step_nm, 0.0, static_cast<double>(table_size - 1));
    const auto i = std::min(static_cast<std::size_t>(t), table_size - 2);
    return std::lerp(table[i], table[i + 1], t - static_cast<double>(i));
}

Triple rgb_from_xyz(Triple c) {
    return {3.2404542 * c[0] - 1.5371385 * c[1] - 0.4985314 * c[2],
            -0.969266 * c[0] + 1.8760108 * c[1] + 0.041556 * c[2],
            0.0556434 * c[0] - 0.2040259 * c[1] + 1.0572252 * c[2]};
}

Spectrum to_spectrum(Triple c) {
    const auto channel = [](double x) { return static_cast<float>(std::max(x, 0.0)); };
    return {channel(c[0]), channel(c[1]), channel(c[2])};
}

/// RGB of the light spectrum `power`, in units in which `normal` has luminance 1.
Triple light_rgb(const std::function<double(double)>& power, const std::function<double(double)>& normal) {
    Triple xyz{};
    double luminance = 0;
    for (int nm = first_nm; nm <= last_nm; ++nm) {
        const double p = power(nm);
        xyz[0] += p * at(cie_x, nm);
        xyz[1] += p * at(cie_y, nm);
        xyz[2] += p * at(cie_z, nm);
        luminance += normal(nm) * at(cie_y, nm);
    }
    if (!(luminance > 0)) return {};
    for (double& c : xyz) c /= luminance;
    return rgb_from_xyz(xyz);
}

double white(double nm) { return at(cie_d65, nm); }

/// Radiance of a black body, W·m⁻²·sr⁻¹·nm⁻¹.
double planck(double nm, double kelvin) {
    const double m = nm * 1e-9;
    return 1.191042972e-25 / (std::pow(m, 5) * std::expm1(0.01438776877 / (m * kelvin)));
}

/// Between the pairs linear, outside of them 0, as pbrt has it.
double sample(std::span<const double> pairs, double nm) {
    const std::size_t count = pairs.size() / 2;
    if (count == 0 || nm < pairs[0] || nm > pairs[2 * (count - 1)]) return 0;
    std::size_t low = 0, high = count - 1;
    while (high - low > 1) {
        const std::size_t middle = (low + high) / 2;
        (pairs[2 * middle] <= nm ? low : high) = middle;
    }
    if (low == high) return pairs[1];
    const double from = pairs[2 * low], to = pairs[2 * high];
    return std::lerp(pairs[2 * low + 1], pairs[2 * high + 1], (nm - from) / (to - from));
}

/// Chromaticity at luminance 1.
Spectrum from_chromaticity(double x, double y) {
    return to_spectrum(rgb_from_xyz({x / y, 1, (1 - x - y) / y}));
}

struct NamedTriple {
    std::string_view name;
    Triple value;
};

// Indices of metals whose reflectance at normal incidence is that of the measured spectra under D65; of
// glasses at 588 nm.
constexpr std::array<NamedTriple, 21> named_indices{{
    {"metal-Ag-eta", {.1285, .1236, .1509}},    {"metal-Ag-k", {4.0947, 3.3263, 2.4079}},
    {"metal-Al-eta", {1.4073, .9266, .5842}},   {"metal-Al-k", {7.6838, 6.5958, 5.3309}},
    {"metal-Au-eta", {.0795, .4066, 1.5595}},   {"metal-Au-k", {8, 2.3388, 1.7195}},
    {"metal-Cu-eta", {.1071, .9772, 1.2047}},   {"metal-Cu-k", {2.861, 2.6244, 2.3604}},
    {"metal-CuZn-eta", {.4182, .5207, 1.1228}}, {"metal-CuZn-k", {4.0642, 2.6569, 1.8118}},
    {"metal-MgO-eta", {1.734, 1.74, 1.755}},    {"metal-MgO-k", {0, 0, 0}},
    {"metal-TiO2-eta", {2.59, 2.67, 2.85}},     {"metal-TiO2-k", {0, 0, 0}},
    {"glass-BK7", {1.5168, 1.5168, 1.5168}},    {"glass-BAF10", {1.67, 1.67, 1.67}},
    {"glass-FK51A", {1.4866, 1.4866, 1.4866}},  {"glass-LASF9", {1.8503, 1.8503, 1.8503}},
    {"glass-F5", {1.6727, 1.6727, 1.6727}},     {"glass-F10", {1.7283, 1.7283, 1.7283}},
    {"glass-F11", {1.7847, 1.7847, 1.7847}},
}};

struct NamedLight {
    std::string_view name;
    double x, y;  // chromaticity
};
constexpr std::array<NamedLight, 16> named_lights{{
    {"stdillum-A", .44757, .40745},
    {"stdillum-D50", .34567, .3585},
    {"stdillum-D65", .3127, .329},
    {"stdillum-F1", .3131, .33727},
    {"stdillum-F2", .37208, .37529},
    {"stdillum-F3", .4091, .3943},
    {"stdillum-F4", .44018, .40329},
    {"stdillum-F5", .31379, .34531},
    {"stdillum-F6", .3779, .38835},
    {"stdillum-F7", .31292, .32933},
    {"stdillum-F8", .34588, .35875},
    {"stdillum-F9", .37417, .37281},
    {"stdillum-F10", .34609, .35986},
    {"stdillum-F11", .38052, .37713},
    {"stdillum-F12", .43695, .40441},
    {"illum-acesD60", .32168, .33767},
}};

std::vector<double> read_pairs(const PbrtParameter& parameter, PbrtFiles& files) {
    const std::vector<std::uint8_t> bytes = files.read(parameter.strings[0], parameter.place);
    PbrtTokenizer tokens(std::string(bytes.begin(), bytes.end()), parameter.strings[0]);
    std::vector<double> pairs;
    while (const std::optional<PbrtToken> token = tokens.next()) {
        double value = 0;
        const char* end = token->text.data() + token->text.size();
        const auto [stop, error] = std::from_chars(token->text.data(), end, value);
        if (error != std::errc{} || stop != end || !std::isfinite(value))
            refuse_pbrt(token->place, "a number", describe(*token));
        pairs.push_back(value);
    }
    return pairs;
}

void check_pairs(std::span<const double> pairs, const PbrtParameter& parameter) {
    if (pairs.size() < 2 || pairs.size() % 2 != 0)
        refuse_pbrt(parameter.place, "pairs of wavelength and value",
                    fmt::format("{} numbers", pairs.size()));
    for (std::size_t i = 2; i < pairs.size(); i += 2)
        if (!(pairs[i] > pairs[i - 2]))
            refuse_pbrt(parameter.place, "increasing wavelengths",
                        fmt::format("{:g} after {:g}", pairs[i], pairs[i - 2]));
}

/// The named spectrum; empty where the name is unknown.
std::optional<Spectrum> named_rgb(const std::string& name, PbrtSpectrumUse use) {
    for (const NamedTriple& entry : named_indices)
        if (entry.name == name) return to_spectrum(entry.value);
    for (const NamedLight& entry : named_lights) {
        if (entry.name != name) continue;
        const Spectrum rgb = from_chromaticity(entry.x, entry.y);
        return use == PbrtSpectrumUse::illuminant ? rgb : rgb / max_component(rgb);
    }
    return {};
}

Spectrum named_or_file(const PbrtParameter& parameter, PbrtSpectrumUse use, PbrtFiles& files) {
    const std::string& name = parameter.strings[0];
    if (const auto rgb = named_rgb(name, use)) return *rgb;
    const bool prefixed = name.starts_with("metal-") || name.starts_with("glass-")
                          || name.starts_with("stdillum-") || name.starts_with("illum-");
    if (prefixed || name.find('.') == name.npos) {
        std::vector<std::string> names;
        for (const NamedTriple& entry : named_indices) names.emplace_back(entry.name);
        for (const NamedLight& entry : named_lights) names.emplace_back(entry.name);
        refuse_pbrt(parameter.place, "the name of a spectrum, or a file of wavelengths and values",
                    quote(name) + did_you_mean(name, names));
    }
    const std::vector<double> pairs = read_pairs(parameter, files);
    check_pairs(pairs, parameter);
    return rgb_of_samples(pairs, use);
}

Spectrum clamped(Spectrum s) {
    const auto channel = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
    return {channel(s.r), channel(s.g), channel(s.b)};
}

}  // namespace

Spectrum blackbody_rgb(double kelvin) {
    const auto power = [&](double nm) { return planck(nm, kelvin); };
    return to_spectrum(light_rgb(power, power));
}

Spectrum blackbody_radiance_rgb(double kelvin) {
    return to_spectrum(light_rgb([&](double nm) { return planck(nm, kelvin); }, [](double) { return 1.0; }));
}

Spectrum light_rgb_of_samples(std::span<const double> pairs) {
    return to_spectrum(light_rgb([&](double nm) { return sample(pairs, nm); }, [](double) { return 1.0; }));
}

Spectrum rgb_of_samples(std::span<const double> pairs, PbrtSpectrumUse use) {
    const auto value = [&](double nm) { return sample(pairs, nm); };
    if (use == PbrtSpectrumUse::illuminant) return to_spectrum(light_rgb(value, value));
    const auto lit = [&](double nm) { return value(nm) * white(nm); };
    const Spectrum rgb = to_spectrum(light_rgb(lit, white));
    return use == PbrtSpectrumUse::albedo ? clamped(rgb) : rgb;
}

Spectrum to_rec709(Spectrum c, PbrtColorSpace space, PbrtSpectrumUse use) {
    using Matrix = std::array<Triple, 3>;
    static constexpr Matrix p3{
        {{1.2247453, -.2249044, 0}, {-.0420579, 1.042081, 0}, {-.0196423, -.0786549, 1.0985372}}};
    static constexpr Matrix rec2020{{{1.6604910, -.5876411, -.0728499},
                                     {-.1245505, 1.1328999, -.0083494},
                                     {-.0181508, -.1005789, 1.1187297}}};
    static constexpr Matrix aces{
        {{2.5579783, -1.1192921, -.3917498},  // without chromatic adaptation: white is D60
         {-.2779919, 1.3660475, -.0934895},
         {-.0171748, -.1485647, 1.0812775}}};
    if (space == PbrtColorSpace::srgb) return c;
    const Matrix& m = space == PbrtColorSpace::dci_p3    ? p3
                      : space == PbrtColorSpace::rec2020 ? rec2020
                                                         : aces;
    Triple out{};
    for (std::size_t i = 0; i < 3; ++i) {
        out[i] = m[i][0] * double{c.r} + m[i][1] * double{c.g} + m[i][2] * double{c.b};
        if (use != PbrtSpectrumUse::illuminant) out[i] /= m[i][0] + m[i][1] + m[i][2];  // white stays white
    }
    return to_spectrum(out);
}

Spectrum pbrt_rgb(const PbrtParameter& p, PbrtSpectrumUse use, PbrtFiles& files) {
    if (p.type == "blackbody") {
        if (!(p.numbers[0] >= 100 && p.numbers[0] <= 1e6))
            refuse_pbrt(p.place, "a temperature of 100 to 1000000 K", fmt::format("{:g}", p.numbers[0]));
        const Spectrum rgb = blackbody_rgb(p.numbers[0]);
        return use == PbrtSpectrumUse::illuminant ? rgb : rgb / max_component(rgb);
    }
    if (p.type == "spectrum") {
        if (!p.strings.empty()) return named_or_file(p, use, files);
        check_pairs(p.numbers, p);
        return rgb_of_samples(p.numbers, use);
    }
    const Spectrum rgb{static_cast<float>(p.numbers[0]), static_cast<float>(p.numbers[1]),
                       static_cast<float>(p.numbers[2])};
    if (rgb.r < 0 || rgb.g < 0 || rgb.b < 0)
        refuse_pbrt(p.place, fmt::format("rgb of at least 0 for {}", quote(p.name)),
                    fmt::format("{:g} {:g} {:g}", rgb.r, rgb.g, rgb.b));
    const Spectrum rec709 = to_rec709(rgb, p.color_space, use);
    return use == PbrtSpectrumUse::albedo ? clamped(rec709) : rec709;
}

}  // namespace relumine
