// SPDX-License-Identifier: Apache-2.0
// The à-trous filter.
#include "integrators/residual_filter.hpp"

#include <array>
#include <utility>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr std::array<float, 3> spline{3.0f / 8, 1.0f / 4, 1.0f / 16};  // B₃, from its middle outwards
constexpr float plane_tolerance = 0.5f;  // off the middle's plane, against a pixel's footprint and the step

/// How alike two points of surfaces are, [0, 1].
float likeness(const FilterGuide& a, const FilterGuide& b, float step) {
    if (a.material != b.material) return 0;
    const float cosine = dot(a.normal, b.normal);
    if (cosine <= 0) return 0;
    float sharpened = sqr(sqr(cosine));  // cos³²
    sharpened = sqr(sqr(sqr(sharpened)));
    const float off = dot(b.position - a.position, a.normal) / (plane_tolerance * step * a.footprint);
    return sharpened / (1 + sqr(sqr(off)));
}

Spectrum ratio(Spectrum a, Spectrum b) {
    const auto channel = [](float x, float y) { return y > 0 ? x / y : 0.0f; };
    return {channel(a.r, b.r), channel(a.g, b.g), channel(a.b, b.b)};
}

/// The mean around a pixel and, over the same weights' squares, the variance of such a mean.
struct Filtered {
    Spectrum mean, variance;
};

Filtered filtered(const FilterImage& image, int x, int y, int step) {
    const auto at = [&](int i, int j) {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(image.width)
               + static_cast<std::size_t>(i);
    };
    const FilterGuide& middle = image.guides[at(x, y)];
    if (middle.footprint <= 0) return {};
    Spectrum sum, squares, weights;
    for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
            const int i = x + dx * step, j = y + dy * step;
            if (i < 0 || i >= image.width || j < 0 || j >= image.height) continue;
            const FilterGuide& guide = image.guides[at(i, j)];
            if (guide.footprint <= 0) continue;
            const float alike = spline[static_cast<std::size_t>(std::abs(dx))]
                                * spline[static_cast<std::size_t>(std::abs(dy))]
                                * likeness(middle, guide, static_cast<float>(step));
            const Spectrum weight = image.weights.empty() ? Spectrum{alike} : image.weights[at(i, j)] * alike;
            sum += image.values[at(i, j)] * weight;
            squares += image.values[at(i, j)] * (weight * weight);
            weights += weight;
        }
    return {ratio(sum, weights), ratio(squares, weights * weights)};
}

/// Replaces all values by use(level, filtered), level by level.
template <typename Use>
void filter(FilterImage& image, int first_level, int levels, int threads, const Use& use) {
    std::vector<Spectrum> next(image.values.size());
    for (int level = first_level; level < levels; ++level) {
        parallel_for(threads, static_cast<std::size_t>(image.height), [&](std::size_t row) {
            for (int x = 0; x < image.width; ++x)
                next[row * static_cast<std::size_t>(image.width) + static_cast<std::size_t>(x)] =
                    use(level, filtered(image, x, static_cast<int>(row), 1 << level));
        });
        std::swap(next, image.values);
    }
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

void filter_level(FilterImage& image, int level, int threads) {
    filter(image, level, level + 1, threads, [](int, const Filtered& f) { return f.mean; });
}

}  // namespace

void filter_along_surfaces(FilterImage& image, int levels, int threads) {
    for (int level = 0; level < levels; ++level) filter_level(image, level, threads);
}

void filter_variances(FilterImage& variances, int levels, int threads) {
    filter(variances, 0, levels, threads, filtered_variance);
}

namespace {

/// Values, and weights if they have any, of an image whose guides several share.
struct Layer {
    std::vector<Spectrum> values, weights;
};

/// Filters one layer of an image after the other, so that guides are held once.
class Layers {
  public:
    Layers(FilterImage guides, int threads) : image_(std::move(guides)), threads_(threads) {}

    [[nodiscard]] std::vector<Spectrum> take_weights() { return std::exchange(image_.weights, {}); }

    void filter_values(Layer& layer, int level) {
        on(layer, [&] { filter_level(image_, level, threads_); });
    }
    void filter_variances(Layer& layer, int level) {
        on(layer, [&] { filter(image_, level, level + 1, threads_, filtered_variance); });
    }
    /// The next level's: those of the values that its own are means of.
    void filter_weights(Layer& layer, int level) {
        if (layer.weights.empty()) return;
        Layer weights{std::move(layer.weights), {}};
        filter_values(weights, level);
        layer.weights = std::move(weights.values);
    }
    /// The luminance of the parts together, squared, and averaged over a pixel's surroundings.
    [[nodiscard]] std::vector<Spectrum> energy(const FilterParts& parts) {
        Layer layer{std::vector<Spectrum>(image_.guides.size()), {}};
        for (std::size_t i = 0; i < layer.values.size(); ++i) {
            Spectrum sum;
            for (const auto& part : parts) sum += part[i];
            layer.values[i] = Spectrum{sqr(luminance(sum))};
        }
        on(layer, [&] { filter_along_surfaces(image_, noise_levels, threads_); });
        return std::move(layer.values);
    }

  private:
    template <typename Run>
    void on(Layer& layer, const Run& run) {
        const auto exchange = [&] {
            std::swap(image_.values, layer.values);
            std::swap(image_.weights, layer.weights);
        };
        exchange();
        run();
        exchange();
    }

    FilterImage image_;  // with neither values nor weights between calls
    int threads_;
};

/// Variances of luminance, weighed by that of the weights.
Layer noise_layer(const std::vector<float>& variances, const std::vector<Spectrum>& weights) {
    Layer noise;
    noise.values.reserve(variances.size());
    noise.weights.reserve(weights.size());
    for (const float v : variances) noise.values.emplace_back(v);
    for (const Spectrum& w : weights) noise.weights.emplace_back(luminance(w));
    return noise;
}

}  // namespace

std::vector<float> smooth_noise(FilterImage guides, FilterParts& parts, const std::vector<float>& variances,
                                int levels, int threads) {
    const std::size_t count = guides.guides.size();
    Layers layers(std::move(guides), threads);
    Layer coarse{{}, layers.take_weights()}, noise = noise_layer(variances, coarse.weights);
    FilterParts kept(parts.size(), std::vector<Spectrum>(count));
    std::vector<float> error(count);
    for (int level = 0; level < levels; ++level) {
        FilterParts details(parts.size());
        for (std::size_t k = 0; k < parts.size(); ++k) {
            coarse.values = parts[k];
            layers.filter_values(coarse, level);
            details[k] = std::move(parts[k]);
            for (std::size_t i = 0; i < count; ++i) details[k][i] = details[k][i] - coarse.values[i];
            parts[k] = std::move(coarse.values);
        }
        const std::vector<Spectrum> seen = layers.energy(details), before = noise.values;
        layers.filter_variances(noise, level);
        layers.filter_weights(coarse, level);
        layers.filter_weights(noise, level);
        for (std::size_t i = 0; i < count; ++i) {
            const float expected = at_level(detail_share, level) * before[i].r + noise.values[i].r;
            const float share = seen[i].r > expected ? 1 - expected / seen[i].r : 0;
            for (std::size_t k = 0; k < parts.size(); ++k) kept[k][i] += details[k][i] * share;
            error[i] += expected * share;
        }
    }
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = 0; k < parts.size(); ++k) parts[k][i] += kept[k][i];
        error[i] += noise.values[i].r;
    }
    return error;
}

}  // namespace relumine
