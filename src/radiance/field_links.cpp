// SPDX-License-Identifier: Apache-2.0
// Jacobi iterations over links.
#include "radiance/field_links.hpp"

#include <cmath>

#include "base/executor.hpp"
#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr float link_unit = 1024;
constexpr std::size_t run = 1024;      // elements of a piece of work
constexpr double least_change = 1e-4;  // of what is still to come, relative to all
constexpr std::size_t most_iterations = 1000;

Spectrum gathered(const FieldLinks& links, std::size_t element, std::span<const Spectrum> from) {
    Spectrum sum;
    for (const Link& link : links.of(element)) sum += link.value() * from[link.to];
    return sum;
}

double total(std::span<const Spectrum> values) {
    double sum = 0;
    for (const Spectrum& s : values)
        sum += std::abs(double{s.r}) + std::abs(double{s.g}) + std::abs(double{s.b});
    return sum;
}

}  // namespace

Spectrum Link::value() const {
    return Spectrum{static_cast<float>(throughput[0]), static_cast<float>(throughput[1]),
                    static_cast<float>(throughput[2])}
           * (1 / link_unit);
}

Link make_link(ElementId to, std::uint16_t ray, std::uint16_t direction, Spectrum t) {
    const float dither = unit_float(static_cast<std::uint32_t>(hash(to, ray, direction)));
    const auto fixed = [&](float x) {
        return static_cast<std::uint16_t>(std::clamp(x * link_unit + dither, 0.0f, 65535.0f));
    };
    return {to, ray, direction, {fixed(t.r), fixed(t.g), fixed(t.b)}};
}

std::uint16_t pack_direction(LocalDir w) {
    const auto byte = [](float x) {
        return static_cast<unsigned>(std::clamp(127.5f * x + 128, 0.0f, 255.0f));
    };
    return static_cast<std::uint16_t>(byte(w.v.x) | byte(w.v.y) << 8);
}

LocalDir unpack_direction(std::uint16_t packed) {
    const auto part = [](int byte) { return (static_cast<float>(byte) - 127.5f) / 127.5f; };
    const float x = part(packed & 255), y = part(packed >> 8);
    return {normalize({x, y, std::sqrt(std::max(0.0f, 1 - x * x - y * y))})};
}

std::size_t iterate(const FieldLinks& links, std::span<const Spectrum> light, float share,
                    std::uint32_t bounces, int threads, std::vector<Spectrum>& irradiance) {
    irradiance.assign(light.begin(), light.end());
    std::vector<Spectrum> arriving(light.begin(), light.end()), next(light.size());
    double before = total(arriving);
    for (std::size_t i = 0; i < std::min<std::size_t>(bounces, most_iterations); ++i) {
        // Only the last bounce's light travels on: sums of ever smaller terms.
        parallel_for(threads, (next.size() + run - 1) / run, [&](std::size_t piece) {
            for (std::size_t e = piece * run; e < std::min((piece + 1) * run, next.size()); ++e) {
                next[e] = gathered(links, e, arriving) * share;
                irradiance[e] += next[e];
            }
        });
        arriving.swap(next);
        const double now = total(arriving);
        const double ratio = before > 0 ? std::min(now / before, 0.999) : 0;
        before = now;
        if (now * ratio / (1 - ratio) <= least_change * total(irradiance)) return i + 1;
    }
    return std::min<std::size_t>(bounces, most_iterations);
}

}  // namespace relumine
