// SPDX-License-Identifier: Apache-2.0
// Jacobi iterations over links.
#include "radiance/field_links.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/executor.hpp"
#include "base/hash.hpp"

namespace relumine {
namespace {

constexpr float link_unit = 1024;
constexpr std::size_t run = 1024;      // elements of a piece of work
constexpr double least_change = 1e-4;  // of what is still to come, relative to all
constexpr std::size_t most_iterations = 1000;
constexpr std::size_t most_at_once = 200;
constexpr std::size_t patience = 24;  // reflections, one after the other, before the rest is found at once

/// What arrived after the last reflections, one after the other.
class Arrivals {
  public:
    /// `kept`: of so many reflections.
    Arrivals(std::size_t elements, std::size_t kept) : kept_(kept, std::vector<Spectrum>(elements)) {}

    void add(std::span<const Spectrum> arriving) {
        std::ranges::copy(arriving, kept_[count_++ % kept_.size()].begin());
    }
    /// `before` the last one; none if that has not been.
    [[nodiscard]] const std::vector<Spectrum>* last(std::size_t before) const {
        before = std::min(before, kept_.size() - 1);
        return before >= count_ ? nullptr : &kept_[(count_ - 1 - before) % kept_.size()];
    }

  private:
    std::vector<std::vector<Spectrum>> kept_;
    std::size_t count_ = 0;
};

/// Lobes on the way have taken their reflections before.
Spectrum gathered(const FieldLinks& links, std::size_t element, const Arrivals& from) {
    Spectrum sum;
    for (const Link& link : links.of(element))
        if (const auto* arriving = from.last(link.lobes)) sum += link.value() * (*arriving)[link.to];
    return sum;
}

std::size_t most_lobes(const FieldLinks& links) {
    std::size_t most = 0;
    for (const Link& link : links.links) most = std::max<std::size_t>(most, link.lobes);
    return most;
}

void add(std::span<const Spectrum> more, std::vector<Spectrum>& sum) {
    for (std::size_t i = 0; i < more.size(); ++i) sum[i] += more[i];
}

/// What further reflections add, if light goes on falling as from one stretch of so many to the next.
double still_to_come(std::span<const double> totals, std::size_t stretch) {
    if (totals.size() < 2 * stretch) return infinity;
    const auto sum = [](std::span<const double> values) {
        return std::accumulate(values.begin(), values.end(), 0.0);
    };
    const double now = sum(totals.last(stretch)), before = sum(totals.last(2 * stretch).first(stretch));
    const double ratio = before > 0 ? std::min(now / before, 0.999) : 0;
    return now * ratio / (1 - ratio);
}

/// Where hardly any light arrives the rest may err towards less than none.
void add_all(std::span<const Spectrum> rest, LightByElement& sum) {
    for (std::size_t i = 0; i < rest.size(); ++i) {
        const Spectrum s = sum[i] + rest[i];
        sum[i] = {std::max(s.r, 0.0f), std::max(s.g, 0.0f), std::max(s.b, 0.0f)};
    }
}

/// Of what reflections, as they go on, are still to bring, relative to what the last one has brought.
double least_left(const Reflections& done, std::span<const Spectrum> irradiance) {
    const double ratio = done.totals.back() / done.totals[done.totals.size() - 2];
    return least_change * total(irradiance) * (1 - std::min(ratio, 0.999));
}

}  // namespace

Spectrum Link::value() const {
    return Spectrum{static_cast<float>(throughput[0]), static_cast<float>(throughput[1]),
                    static_cast<float>(throughput[2])}
           * (1 / link_unit);
}

Link make_link(ElementId to, std::uint16_t ray, std::uint16_t direction, Spectrum t, std::uint8_t lobes) {
    const float dither = unit_float(static_cast<std::uint32_t>(hash(to, ray, direction)));
    const auto fixed = [&](float x) {
        return static_cast<std::uint16_t>(std::clamp(x * link_unit + dither, 0.0f, 65535.0f));
    };
    return {to, ray, direction, {fixed(t.r), fixed(t.g), fixed(t.b)}, lobes};
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

float Reflections::share_without(std::size_t reflections) const {
    double all = 0, left = 0;
    for (std::size_t i = 0; i < totals.size(); ++i) {
        all += totals[i];
        if (i + reflections <= limit) left += totals[i];
    }
    return all > 0 ? static_cast<float>(left / all) : 1;
}

Reflections iterate(const FieldLinks& links, const ElementLight& light, float share, std::uint32_t bounces,
                    int threads, std::vector<Spectrum>& irradiance) {
    // Without a limit all light arrives, however many reflections lobes take.
    const bool limited = bounces < most_iterations;
    const std::size_t count = light.straight.size(), delay = limited ? most_lobes(links) : 0;
    const auto reflect = [&](const Arrivals& from, LightByElement& to) {
        parallel_for(threads, (count + run - 1) / run, [&](std::size_t piece) {
            for (std::size_t e = piece * run; e < std::min((piece + 1) * run, count); ++e)
                to[e] = gathered(links, e, from) * share;
        });
    };
    LightByElement arriving = light.straight;
    if (!limited) add(light.reflected, arriving);
    irradiance = arriving;
    Reflections done{{total(arriving)}, bounces};
    Arrivals arrivals(count, delay + 1);
    arrivals.add(arriving);
    while (done.computed() < std::min<std::size_t>(bounces, most_iterations)) {
        // Only the last bounce's light travels on: sums of ever smaller terms.
        reflect(arrivals, arriving);
        if (limited && done.computed() == 0) add(light.reflected, arriving);
        done.totals.push_back(total(arriving));
        if (!limited && done.computed() == patience) {
            const AllReflections rest =
                all_reflections(arriving, least_left(done, irradiance), most_at_once,
                                [&](std::span<const Spectrum> from, LightByElement& to) {
                                    arrivals.add(from);
                                    reflect(arrivals, to);
                                });
            done.at_once = rest.asked;
            if (rest.converged) {
                add_all(rest.light, irradiance);
                break;
            }
        }
        add(arriving, irradiance);
        arrivals.add(arriving);
        if (still_to_come(done.totals, delay + 1) <= least_change * total(irradiance)) break;
    }
    return done;
}

}  // namespace relumine
