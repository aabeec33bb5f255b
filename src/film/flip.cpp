// SPDX-License-Identifier: Apache-2.0
// FLIP: how much a viewer who alternates between two pictures sees of their difference [Andersson20].
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "film/compare.hpp"
#include "relumine/compare.hpp"

namespace relumine {
namespace {

using namespace compare;

constexpr double pi = std::numbers::pi;
constexpr double square(double x) { return x * x; }
constexpr Rgb white{0.950428545, 1, 1.088900371};  // XYZ of D65

Rgb xyz_of(const Rgb& c) {
    return {c[0] * 10135552 / 24577794 + c[1] * 8788810 / 24577794 + c[2] * 4435075 / 24577794,
            c[0] * 2613072 / 12288897 + c[1] * 8788810 / 12288897 + c[2] * 887015 / 12288897,
            c[0] * 1425312 / 73733382 + c[1] * 8788810 / 73733382 + c[2] * 70074185 / 73733382};
}

Rgb rgb_of(const Rgb& c) {
    return {3.241003275 * c[0] - 1.537398934 * c[1] - 0.498615861 * c[2],
            -0.969224334 * c[0] + 1.875930071 * c[1] + 0.041554224 * c[2],
            0.055639423 * c[0] - 0.204011202 * c[1] + 1.057148933 * c[2]};
}

/// The linear opponent space in which the filters for contrast sensitivity work.
Rgb ycxcz_of(const Rgb& linear) {
    const Rgb c = xyz_of(linear);
    const double x = c[0] / white[0], y = c[1], z = c[2] / white[2];
    return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Rgb linear_of_ycxcz(const Rgb& c) {
    const double y = (c[0] + 16) / 116;
    return rgb_of({white[0] * (y + c[1] / 500), y, white[2] * (y - c[2] / 200)});
}

/// CIELAB, its chroma lowered where it is dark, as Hunt found.
Rgb hunt_lab_of(const Rgb& linear) {
    const auto f = [](double t) {
        constexpr double delta = 6.0 / 29;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
    };
    const Rgb c = xyz_of(linear);
    const double x = f(c[0] / white[0]), y = f(c[1]), z = f(c[2] / white[2]);
    const double lightness = 116 * y - 16;
    return {lightness, 0.01 * lightness * 500 * (x - y), 0.01 * lightness * 200 * (y - z)};
}

double hyab(const Rgb& a, const Rgb& b) {
    return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

/// A picture of one number per pixel; beyond its border it goes on as the border is.
struct Plane {
    int width, height;
    std::vector<double> values;

    Plane(int w, int h)
        : width(w), height(h), values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h)) {}
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(std::clamp(y, 0, height - 1)) * static_cast<std::size_t>(width)
               + static_cast<std::size_t>(std::clamp(x, 0, width - 1));
    }
};

/// A filter of 2 · radius + 1 weights along one axis.
using Kernel = std::vector<double>;

template <typename F>
Kernel sampled(int radius, F f) {
    Kernel kernel;
    for (int i = -radius; i <= radius; ++i) kernel.push_back(f(static_cast<double>(i)));
    return kernel;
}

Plane filtered(const Plane& in, const Kernel& along_x, const Kernel& along_y) {
    const auto pass = [](const Plane& from, const Kernel& kernel, int dx, int dy) {
        Plane to(from.width, from.height);
        const int radius = static_cast<int>(kernel.size()) / 2;
        for (int y = 0; y < from.height; ++y)
            for (int x = 0; x < from.width; ++x) {
                double sum = 0;
                for (int i = -radius; i <= radius; ++i)
                    sum += kernel[static_cast<std::size_t>(i + radius)]
                           * from.values[from.index(x + i * dx, y + i * dy)];
                to.values[to.index(x, y)] = sum;
            }
        return to;
    };
    return pass(pass(in, along_x, 1, 0), along_y, 0, 1);
}

double sum_of(const Kernel& kernel) {
    double sum = 0;
    for (const double k : kernel) sum += k;
    return sum;
}

/// Contrast sensitivity of one channel: a sum of Gaussians a·√(π/b)·exp(−π²d²/b), d in degrees.
struct Sensitivity {
    double a1, b1, a2, b2;
};
constexpr std::array sensitivities{Sensitivity{1, 0.0047, 0, 1e-5}, Sensitivity{1, 0.0053, 0, 1e-5},
                                   Sensitivity{34.1, 0.04, 13.5, 0.025}};

Plane seen(const Plane& plane, const Sensitivity& s, double pixels_per_degree) {
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * pi * pi)) * pixels_per_degree));
    Plane result(plane.width, plane.height);
    double total = 0;
    for (const auto& [a, b] : {std::pair{s.a1, s.b1}, std::pair{s.a2, s.b2}}) {
        if (a == 0) continue;
        const Kernel gauss = sampled(
            radius, [&, b = b](double i) { return std::exp(-square(pi * i / pixels_per_degree) / b); });
        const double weight = a * std::sqrt(pi / b);
        const Plane part = filtered(plane, gauss, gauss);
        for (std::size_t i = 0; i < part.values.size(); ++i) result.values[i] += weight * part.values[i];
        total += weight * square(sum_of(gauss));
    }
    for (double& value : result.values) value /= total;
    return result;
}

/// The strength of edges (first derivative) or of points (second) in lightness, in [0, 1].
Plane features(const Plane& lightness, double pixels_per_degree, bool edges) {
    const double deviation =
        0.5 * 0.082 * pixels_per_degree;  // the width of what the eye tells apart, degrees
    const int radius = static_cast<int>(std::ceil(3 * deviation));
    Kernel gauss = sampled(radius, [&](double i) { return std::exp(-square(i / deviation) / 2); });
    const double total = sum_of(gauss);
    for (double& g : gauss) g /= total;
    Kernel derivative = sampled(radius, [&](double i) {
        return (edges ? -i : square(i / deviation) - 1) * std::exp(-square(i / deviation) / 2);
    });
    double positive = 0, negative = 0;
    for (const double d : derivative) (d > 0 ? positive : negative) += std::abs(d);
    for (double& d : derivative) d /= d > 0 ? positive : negative;
    const Plane x = filtered(lightness, derivative, gauss), y = filtered(lightness, gauss, derivative);
    Plane strength(lightness.width, lightness.height);
    for (std::size_t i = 0; i < x.values.size(); ++i)
        strength.values[i] = std::hypot(x.values[i], y.values[i]);
    return strength;
}

/// A picture as it is shown and as it is seen.
struct Seen {
    std::vector<Rgb> lab;  // after the eye's filter
    Plane edges, points;
};

Seen look_at(const Picture& picture, const FlipOptions& options) {
    const int w = picture.width(), h = picture.height();
    std::array<Plane, 3> channels{Plane(w, h), Plane(w, h), Plane(w, h)};
    const double factor = std::exp2(options.exposure);
    for (int y = 0; y < h; ++y)
        for (int x = 0; x < w; ++x) {
            Rgb c = picture.at(x, y);
            for (double& value : c) value = std::isnan(value) ? 0 : std::clamp(factor * value, 0.0, 1.0);
            const Rgb opponent = ycxcz_of(c);
            for (std::size_t i = 0; i < 3; ++i) channels[i].values[channels[i].index(x, y)] = opponent[i];
        }
    Plane lightness = channels[0];
    for (double& value : lightness.values) value = (value + 16) / 116;
    Seen result{{},
                features(lightness, options.pixels_per_degree, true),
                features(lightness, options.pixels_per_degree, false)};
    for (std::size_t i = 0; i < 3; ++i)
        channels[i] = seen(channels[i], sensitivities[i], options.pixels_per_degree);
    for (std::size_t i = 0; i < lightness.values.size(); ++i) {
        Rgb c = linear_of_ycxcz({channels[0].values[i], channels[1].values[i], channels[2].values[i]});
        for (double& value : c) value = std::clamp(value, 0.0, 1.0);
        result.lab.push_back(hunt_lab_of(c));
    }
    return result;
}

/// The colour difference on a scale to 1, where large differences count less than in proportion.
double colour_difference(const Rgb& a, const Rgb& b) {
    constexpr double exponent = 0.7, knee = 0.4, knee_value = 0.95;
    static const double most = std::pow(hyab(hunt_lab_of({0, 1, 0}), hunt_lab_of({0, 0, 1})), exponent);
    const double difference = std::pow(hyab(a, b), exponent);
    if (difference < knee * most) return knee_value / (knee * most) * difference;
    return knee_value + (difference - knee * most) / (most - knee * most) * (1 - knee_value);
}

}  // namespace

Flip flip(const Image& image, const Image& reference, const FlipOptions& options) {
    check(std::isfinite(options.exposure), "exposure of FLIP", "a finite number of stops", options.exposure);
    check(options.pixels_per_degree > 0 && options.pixels_per_degree <= 1000, "pixels per degree of FLIP",
          "a number above 0, at most 1000", options.pixels_per_degree);
    const Picture picture(image, "image"), expected(reference, "reference");
    check_same_size(picture, expected, "image");
    const Seen a = look_at(picture, options), b = look_at(expected, options);
    Flip result;
    for (std::size_t i = 0; i < a.lab.size(); ++i) {
        const double feature = std::max(std::abs(a.edges.values[i] - b.edges.values[i]),
                                        std::abs(a.points.values[i] - b.points.values[i]));
        const double value =
            std::pow(colour_difference(a.lab[i], b.lab[i]), 1 - std::sqrt(feature / std::numbers::sqrt2));
        result.mean += value;
        result.pixels.push_back(static_cast<float>(value));
    }
    result.mean /= static_cast<double>(a.lab.size());
    return result;
}

}  // namespace relumine
