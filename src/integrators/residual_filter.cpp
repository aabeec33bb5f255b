// SPDX-License-Identifier: Apache-2.0
// The à-trous filter.
#include "integrators/residual_filter.hpp"

#include <array>
#include <span>
#include <utility>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr std::array<float, 3> spline{3.0f / 8, 1.0f / 4, 1.0f / 16};  // B₃, from its middle outwards
constexpr float plane_tolerance = 0.5f;  // off the middle's plane, against a pixel's footprint and the step

constexpr float least_rise = 0.2f;  // sine of the angle at which what rises from a surface meets it
constexpr float most_gap = 8;       // between neighbours that touch, of the pixels that they cover

/// By distances to contacts, how alike these are: what is twice as far away hardly is.
constexpr std::array<std::array<float, contact_reach + 2>, contact_reach + 2> contact_likeness = [] {
    std::array<std::array<float, contact_reach + 2>, contact_reach + 2> table{};
    for (std::size_t a = 0; a < table.size(); ++a)
        for (std::size_t b = 0; b < table.size(); ++b) {
            const float larger = static_cast<float>(std::max(a, b)) + 0.5f,
                        smaller = static_cast<float>(std::min(a, b)) + 0.5f;
            const float apart = 3 * (larger / smaller - 1);
            table[a][b] = 1 / (1 + apart * apart * apart * apart);
        }
    return table;
}();

/// How alike two points of surfaces are, [0, 1].
float likeness(const FilterGuide& a, const FilterGuide& b, float step) {
    if (a.material != b.material) return 0;
    const float cosine = dot(a.normal, b.normal);
    if (cosine <= 0) return 0;
    float sharpened = sqr(sqr(cosine));  // cos³²
    sharpened = sqr(sqr(sqr(sharpened)));
    const float off = dot(b.position - a.position, a.normal) / (plane_tolerance * step * a.footprint);
    const float near =
        contact_likeness[static_cast<std::size_t>(a.contact)][static_cast<std::size_t>(b.contact)];
    return sharpened * near / (1 + sqr(sqr(off)));
}

/// Whether the surface at `b`, so many pixels away, rises from that at `a`.
bool rises(const FilterGuide& a, const FilterGuide& b, int pixels) {
    if (b.footprint <= 0) return false;
    const Vec3 way = b.position - a.position;
    const float distance = length(way);
    return dot(way, a.normal) > least_rise * distance
           && distance < most_gap * static_cast<float>(pixels) * a.footprint;
}

/// Pixels to the nearest contact, along the picture's axes.
int contact_distance(const FilterImage& image, int x, int y) {
    const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width)
               + static_cast<std::size_t>(i);
    };
    const FilterGuide& middle = image.guides[at(x, y)];
    int nearest = contact_reach + 1;
    if (middle.footprint <= 0) return nearest;
    for (int j = std::max(0, y - contact_reach); j <= std::min(image.height - 1, y + contact_reach); ++j)
        for (int i = std::max(0, x - contact_reach); i <= std::min(image.width - 1, x + contact_reach); ++i) {
            const int pixels = std::max(std::abs(i - x), std::abs(j - y));
            if (pixels > 0 && pixels < nearest && rises(middle, image.guides[at(i, j)], pixels))
                nearest = pixels;
        }
    return nearest;
}

Spectrum ratio(Spectrum a, Spectrum b) {
    const auto channel = [](float x, float y) { return y > 0 ? x / y : 0.0f; };
    return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

/// The pixels around one that show its surface, and how much each counts.
struct Surroundings {
    static constexpr std::size_t most = 25;

    std::array<std::size_t, most> pixels;
    std::array<float, most> alike;
    std::size_t count = 0;
};

Surroundings surroundings(const FilterImage& image, int x, int y, int step) {
    const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width)
               + static_cast<std::size_t>(i);
    };
    const FilterGuide& middle = image.guides[at(x, y)];
    Surroundings around;
    if (middle.footprint <= 0) return around;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int i = x + dx * step, j = y + dy * step;
            if (i < 0 || i >= image.width || j < 0 || j >= image.height) continue;
            const FilterGuide& guide = image.guides[at(i, j)];
            if (guide.footprint <= 0) continue;
            const float alike = likeness(middle, guide, static_cast<float>(step));
            if (alike == 0) continue;
            around.pixels[around.count] = at(i, j);
            around.alike[around.count++] = spline[static_cast<std::size_t>(std::abs(dx))]
                                           * spline[static_cast<std::size_t>(std::abs(dy))] * alike;
        }
    return around;
}

/// The mean around a pixel and, over the same weights' squares, the variance of such a mean.
struct Filtered {
    Spectrum mean, variance;
};

/// `weights`: of values in means; empty: all the same.
Filtered filtered(const Surroundings& around, std::span<const Spectrum> values,
                  std::span<const Spectrum> weights) {
    Spectrum sum, squares, all;
    for (std::size_t k = 0; k < around.count; ++k) {
        const std::size_t i = around.pixels[k];
        const Spectrum weight = weights.empty() ? Spectrum{around.alike[k]} : weights[i] * around.alike[k];
        sum += values[i] * weight;
        squares += values[i] * (weight * weight);
        all += weight;
    }
    return {ratio(sum, all), ratio(squares, all * all)};
}

// By level, of white noise on an open plane under B₃: Σw² of all levels together over that of those before,
// over Σw² of the level alone; and a in a v + v', the variance of the difference that the level makes where
// variance v becomes v'. Around a noisy pixel v' counts as it is: what has come there is the difference.
constexpr std::array<float, 4> correlation{1, 2.86f, 3.19f, 3.29f};
constexpr std::array<float, 4> detail_share{0.72f, 0.32f, 0.24f, 0.22f};

float at_level(const std::array<float, 4>& factors, int level) {
    return factors[std::min(static_cast<std::size_t>(level), factors.size() - 1)];
}

Spectrum filtered_variance(int level, const Filtered& f) {
    const float more = at_level(correlation, level);
    const auto channel = [&](float mean, float variance) { return std::min(mean, more * variance); };
    return {channel(f.mean.r, f.variance.r), channel(f.mean.g, f.variance.g),
            channel(f.mean.b, f.variance.b)};
}

/// Values that are filtered beside others: how alike pixels are is the same for all.
struct Layer {
    enum class Kind : std::uint8_t { values, variances };

    std::vector<Spectrum> values;
    const Layer* weights = nullptr;  // of `values` in means
    Kind kind = Kind::values;
    std::vector<Spectrum> before{};  // the values before the last level
};

void filter_level(const FilterImage& guides, std::span<Layer* const> layers, int level, int threads) {
    for (Layer* layer : layers) layer->before.resize(guides.guides.size());
    parallel_for(threads, static_cast<std::size_t>(guides.height), [&](std::size_t row) {
        for (int x = 0; x < guides.width; ++x) {
            const Surroundings around = surroundings(guides, x, static_cast<int>(row), 1 << level);
            const std::size_t i = row * static_cast<std::size_t>(guides.width) + static_cast<std::size_t>(x);
            for (Layer* layer : layers) {
                const Filtered f =
                    filtered(around, layer->values,
                             layer->weights ? std::span(layer->weights->values) : std::span<Spectrum>{});
                layer->before[i] =
                    layer->kind == Layer::Kind::variances ? filtered_variance(level, f) : f.mean;
            }
        }
    });
    for (Layer* layer : layers) std::swap(layer->values, layer->before);
}

/// A picture's own values.
void filter_picture(FilterImage& image, Layer::Kind kind, int levels, int threads) {
    const Layer weights{std::move(image.weights)};
    Layer layer{std::move(image.values), weights.values.empty() ? nullptr : &weights, kind};
    for (int level = 0; level < levels; ++level) filter_level(image, std::array{&layer}, level, threads);
    image.values = std::move(layer.values);
    image.weights = weights.values;
}

}  // namespace

void find_contacts(FilterImage& image, int threads) {
    parallel_for(threads, static_cast<std::size_t>(image.height), [&](std::size_t row) {
        for (int x = 0; x < image.width; ++x)
            image.guides[row * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)].contact =
                contact_distance(image, x, static_cast<int>(row));
    });
}

void filter_along_surfaces(FilterImage& image, int levels, int threads) {
    filter_picture(image, Layer::Kind::values, levels, threads);
}

void filter_variances(FilterImage& variances, int levels, int threads) {
    filter_picture(variances, Layer::Kind::variances, levels, threads);
}

void filter_along_surfaces(const FilterImage& guides, FilterParts& parts, int levels, int threads) {
    FilterParts none;
    filter_along_surfaces(guides, parts, none, levels, threads);
}

void filter_along_surfaces(const FilterImage& guides, FilterParts& parts, FilterParts& variances, int levels,
                           int threads) {
    std::vector<Layer> layers;
    for (auto& part : parts) layers.push_back({std::move(part), nullptr, Layer::Kind::values});
    for (auto& part : variances) layers.push_back({std::move(part), nullptr, Layer::Kind::variances});
    std::vector<Layer*> all;
    for (Layer& layer : layers) all.push_back(&layer);
    for (int level = 0; level < levels; ++level) filter_level(guides, all, level, threads);
    std::size_t k = 0;
    for (FilterParts* group : {&parts, &variances})
        for (auto& part : *group) part = std::move(layers[k++].values);
}

namespace {

/// What smooth_noise filters, level by level.
class Smoothing {
  public:
    Smoothing(FilterImage guides, FilterParts& parts, const NoiseVariances& variances, int threads)
        : guides_(std::move(guides)), threads_(threads), parts_(parts.size()) {
        weights_.values = std::exchange(guides_.weights, {});
        const bool weighed = !weights_.values.empty();
        noise_weights_.values.reserve(weights_.values.size());
        for (const Spectrum& w : weights_.values) noise_weights_.values.emplace_back(luminance(w));
        noise_.values.reserve(variances.expected.size());
        for (std::size_t i = 0; i < variances.expected.size(); ++i)
            noise_.values.emplace_back(variances.expected[i], variances.cautious[i], 0.0f);
        noise_.kind = Layer::Kind::variances;
        noise_.weights = weighed ? &noise_weights_ : nullptr;
        for (std::size_t k = 0; k < parts.size(); ++k) {
            parts_[k] = {std::move(parts[k]), weighed ? &weights_ : nullptr, Layer::Kind::values};
            all_.push_back(&parts_[k]);
        }
        all_.push_back(&noise_);
        if (weighed) all_.insert(all_.end(), {&weights_, &noise_weights_});
    }

    /// Smooths everything; what the parts lose by it are the details.
    void filter(int level) {
        filter_level(guides_, all_, level, threads_);
        for (Layer& part : parts_)
            for (std::size_t i = 0; i < part.values.size(); ++i)
                part.before[i] = part.before[i] - part.values[i];
    }

    [[nodiscard]] std::size_t parts() const { return parts_.size(); }
    [[nodiscard]] std::vector<Spectrum>& values(std::size_t part) { return parts_[part].values; }
    [[nodiscard]] const std::vector<Spectrum>& details(std::size_t part) const { return parts_[part].before; }
    /// Its variance that is left after all levels so far, expected.
    [[nodiscard]] float noise(std::size_t i) const { return noise_.values[i].r; }

    struct DetailNoise {
        float expected, cautious;
    };
    /// Variances of the last level's details.
    [[nodiscard]] DetailNoise detail_noise(std::size_t i, int level) const {
        const Spectrum sum = noise_.before[i] * at_level(detail_share, level) + noise_.values[i];
        return {sum.r, sum.g};
    }

    /// The luminance of the details together, squared, and averaged over a pixel's surroundings.
    [[nodiscard]] std::vector<Spectrum> energy() const {
        FilterParts squares(1);
        squares[0].reserve(guides_.guides.size());
        for (std::size_t i = 0; i < guides_.guides.size(); ++i) {
            Spectrum sum;
            for (const Layer& part : parts_) sum += part.before[i];
            squares[0].emplace_back(sqr(luminance(sum)));
        }
        filter_along_surfaces(guides_, squares, noise_levels, threads_);
        return std::move(squares[0]);
    }

  private:
    FilterImage guides_;  // with neither values nor weights
    int threads_;
    std::vector<Layer> parts_;
    Layer weights_, noise_, noise_weights_;
    std::vector<Layer*> all_;
};

}  // namespace

std::vector<float> smooth_noise(FilterImage guides, FilterParts& parts, const NoiseVariances& variances,
                                int levels, int threads) {
    const std::size_t count = guides.guides.size();
    Smoothing smoothing(std::move(guides), parts, variances, threads);
    FilterParts kept(smoothing.parts(), std::vector<Spectrum>(count));
    std::vector<float> error(count);
    for (int level = 0; level < levels; ++level) {
        smoothing.filter(level);
        const std::vector<Spectrum> seen = smoothing.energy();
        for (std::size_t i = 0; i < count; ++i) {
            const auto noise = smoothing.detail_noise(i, level);
            const float share = seen[i].r > noise.cautious ? 1 - noise.cautious / seen[i].r : 0;
            for (std::size_t k = 0; k < kept.size(); ++k) kept[k][i] += smoothing.details(k)[i] * share;
            error[i] +=
                sqr(1 - share) * std::max(0.0f, seen[i].r - noise.expected) + sqr(share) * noise.expected;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < kept.size(); ++k) kept[k][i] = smoothing.values(k)[i] + kept[k][i];
        error[i] += smoothing.noise(i);
    }
    parts = std::move(kept);
    return error;
}

}  // namespace relumine
