// SPDX-License-Identifier: Apache-2.0
// Biconjugate gradients.
#include "radiance/field_solver.hpp"

#include <cmath>
#include <utility>

namespace relumine {
namespace {

double inner(std::span<const Spectrum> a, std::span<const Spectrum> b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        sum += double{a[i].r} * double{b[i].r} + double{a[i].g} * double{b[i].g}
               + double{a[i].b} * double{b[i].b};
    return sum;
}

void add(LightByElement& light, std::span<const Spectrum> more, double times) {
    for (std::size_t i = 0; i < light.size(); ++i) light[i] += more[i] * static_cast<float>(times);
}

/// (1 − K) light
void keep_back(const Reflect& reflect, std::span<const Spectrum> light, LightByElement& kept) {
    reflect(light, kept);
    for (std::size_t i = 0; i < light.size(); ++i) kept[i] = light[i] - kept[i];
}

}  // namespace

double total(std::span<const Spectrum> light) {
    double sum = 0;
    for (const Spectrum& s : light)
        sum += std::abs(double{s.r}) + std::abs(double{s.g}) + std::abs(double{s.b});
    return sum;
}

/// Letters are those of the paper.
AllReflections all_reflections(LightByElement arriving, double least, std::size_t most_asked,
                               const Reflect& reflect) {
    AllReflections x{LightByElement(arriving.size())};
    LightByElement r = arriving, p = arriving, v(r.size()), t(r.size());
    const LightByElement& shadow = arriving;
    double rho = inner(shadow, r);
    while (x.asked < most_asked) {
        keep_back(reflect, p, v);
        const double alpha = rho / inner(shadow, v);
        add(x.light, p, alpha);
        add(r, v, -alpha);
        keep_back(reflect, r, t);
        const double omega = inner(t, r) / inner(t, t);
        add(x.light, r, omega);
        add(r, t, -omega);
        x.asked += 2;
        const double left = total(r), before = std::exchange(rho, inner(shadow, r));
        x.converged = left <= least;
        if (x.converged || !std::isfinite(left)) break;
        add(p, v, -omega);
        const double beta = rho / before * alpha / omega;
        for (std::size_t i = 0; i < p.size(); ++i) p[i] = r[i] + p[i] * static_cast<float>(beta);
    }
    return x;
}

}  // namespace relumine
