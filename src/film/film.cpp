// SPDX-License-Identifier: Apache-2.0
// The film.
#include "film/film.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <span>

#include "base/assert.hpp"

namespace relumine {
namespace {

enum class Develop {
    mean,
    first /* value of sample 0 */,
    variance /* from sums and sums of squares */,
    error /* from sums of luminance, its variance and what errs alike in all passes */,
    samples
};

void put(std::span<float> out, Spectrum s) {
    out[0] = s.r;
    out[1] = s.g;
    out[2] = s.b;
}
void put(std::span<float> out, Vec3 v) {
    out[0] = v.x;
    out[1] = v.y;
    out[2] = v.z;
}

/// The variance of the mean of `n` samples from their sum and sum of squares, as if they were independent.
float variance_of_mean(float sum, float sum_of_squares, float n) {
    if (n < 2) return 0;
    const double mean = static_cast<double>(sum) / n;
    return static_cast<float>(std::max(0.0, static_cast<double>(sum_of_squares) / n - mean * mean)
                              / (static_cast<double>(n) - 1));
}

/// One sigma over the value itself; the number of samples cancels out. 0 where nothing is known or all black.
float relative_error(float sum, float variance, float deviation) {
    return sum > 0 ? std::sqrt(std::max(0.0f, variance) + deviation * deviation) / sum : 0;
}

}  // namespace

/// A layer: its channels and what of a pixel's sums goes into them.
struct Film::LayerSpec {
    const char* name;
    std::vector<std::string> channels;
    Develop develop;
    void (*extract)(const PixelSums&, std::span<float>);
    bool surface = false;  // needs FirstSurface

    /// Floats kept per pixel.
    [[nodiscard]] std::size_t stored() const {
        const std::size_t sums = develop == Develop::variance ? 2 : develop == Develop::error ? 3 : 1;
        return sums * channels.size();
    }
};

const std::vector<Film::LayerSpec>& Film::known_layers() {
    using S = const PixelSums&;
    using Out = std::span<float>;
    const std::vector<std::string> rgb{"R", "G", "B"}, xyz{"X", "Y", "Z"};
    static const std::vector<LayerSpec> layers{
        {"", rgb, Develop::mean, [](S p, Out o) { put(o, p.radiance); }},
        {"albedo", rgb, Develop::mean, [](S p, Out o) { put(o, p.albedo); }, true},
        {"normal", xyz, Develop::mean, [](S p, Out o) { put(o, p.normal); }, true},
        {"position", xyz, Develop::first, [](S p, Out o) { put(o, p.first.position); }, true},
        {"depth", {"Z"}, Develop::first, [](S p, Out o) { o[0] = p.first.depth; }, true},
        {"material_id", {"ID"}, Develop::first, [](S p, Out o) { o[0] = p.first.material_id; }, true},
        {"emission", rgb, Develop::mean, [](S p, Out o) { put(o, p.split.emission); }},
        {"direct", rgb, Develop::mean, [](S p, Out o) { put(o, p.split.direct); }},
        {"indirect", rgb, Develop::mean, [](S p, Out o) { put(o, p.split.indirect); }},
        {"samples", {"N"}, Develop::samples, [](S p, Out o) { o[0] = static_cast<float>(p.samples); }},
        {"records", {"N"}, Develop::mean, [](S p, Out o) { o[0] = p.cache.records; }},
        {"gaps", {"Y"}, Develop::mean, [](S p, Out o) { o[0] = p.cache.gaps; }},
        {"layers", {"N"}, Develop::mean, [](S p, Out o) { o[0] = p.cache.layers; }},
        {"unknown", {"Y"}, Develop::mean, [](S p, Out o) { o[0] = p.cache.unknown; }},
        {"variance", rgb, Develop::variance,
         [](S p, Out o) {
             put(o, p.radiance);
             put(o.subspan(3), p.radiance_squared);
         }},
        {"error",
         {"Y"},
         Develop::error,
         [](S p, Out o) {
             o[0] = luminance(p.radiance);
             o[1] = p.error.variance;
             o[2] = p.error.deviation;
         }},
    };
    return layers;
}

std::vector<std::string> film_layer_names() {
    return {"albedo",  "normal",  "position", "depth",  "material_id", "emission", "direct", "indirect",
            "samples", "records", "gaps",     "layers", "unknown",     "variance", "error"};
}

bool needs_surfaces(const std::vector<std::string>& layers) {
    const std::array surface_layers{"albedo", "normal", "position", "depth", "material_id"};
    return std::ranges::any_of(layers, [&](const std::string& name) {
        return std::ranges::find(surface_layers, name) != surface_layers.end();
    });
}

FilmBytes film_bytes(std::uint64_t pixels, const std::vector<std::string>& layers) {
    const auto [stored, shown] = Film::floats_per_pixel(layers);
    return {pixels * 2 * (stored * sizeof(float) + sizeof(std::uint32_t)), pixels * shown * sizeof(float)};
}

Film::Film(int frame_width, int frame_height, const PixelRect& window, const std::vector<std::string>& layers)
    : frame_width_(frame_width), frame_height_(frame_height), window_(window) {
    const auto add_layer = [&](const std::string& name) {
        const auto& known = known_layers();
        const auto found =
            std::ranges::find_if(known, [&](const LayerSpec& spec) { return spec.name == name; });
        RELUMINE_ASSERT(found != known.end());
        layers_.push_back(&*found);
        channels_ += found->stored();
    };
    add_layer("");
    for (const std::string& name : layers) add_layer(name);
    const std::size_t pixels =
        static_cast<std::size_t>(window.width()) * static_cast<std::size_t>(window.height());
    finished_.resize(pixels * channels_);
    pending_.resize(pixels * channels_);
    finished_samples_.resize(pixels);
    pending_samples_.resize(pixels);
}

std::pair<std::size_t, std::size_t> Film::floats_per_pixel(const std::vector<std::string>& layers) {
    std::size_t stored = 0, shown = 0;
    for (const LayerSpec& spec : known_layers()) {
        const bool wanted = std::ranges::find(layers, spec.name) != layers.end();
        if (!wanted && *spec.name != 0) continue;
        stored += spec.stored();
        shown += spec.channels.size();
    }
    return {stored, shown};
}

std::size_t Film::offset(int x, int y) const {
    return static_cast<std::size_t>(y - window_.y0) * static_cast<std::size_t>(window_.width())
           + static_cast<std::size_t>(x - window_.x0);
}

void Film::add(const Tile& tile) {
    const PixelSums* sums = tile.pixels.data();
    for (int y = tile.rect.y0; y < tile.rect.y1; ++y)
        for (int x = tile.rect.x0; x < tile.rect.x1; ++x, ++sums) {
            const std::size_t pixel = offset(x, y);
            float* out = &pending_[pixel * channels_];
            for (const LayerSpec* layer : layers_) {
                layer->extract(*sums, {out, layer->stored()});
                out += layer->stored();
            }
            pending_samples_[pixel] = sums->samples;
        }
}

void Film::finish_pass() {
    for (std::size_t i = 0; i < finished_.size(); ++i) finished_[i] += pending_[i];
    for (std::size_t i = 0; i < finished_samples_.size(); ++i) finished_samples_[i] += pending_samples_[i];
    std::ranges::fill(pending_, 0.0f);
    std::ranges::fill(pending_samples_, 0u);
    ++passes_;
}

FilmState Film::state(std::span<const PixelRect> done) const {
    FilmState state{passes_, finished_, {}, finished_samples_, {}};
    if (done.empty()) return state;
    state.pending.resize(pending_.size());
    state.pending_samples.resize(pending_samples_.size());
    for (const PixelRect& tile : done)
        for (int y = tile.y0; y < tile.y1; ++y) {
            const std::size_t begin = offset(tile.x0, y), count = static_cast<std::size_t>(tile.width());
            std::copy_n(&pending_[begin * channels_], count * channels_, &state.pending[begin * channels_]);
            std::copy_n(&pending_samples_[begin], count, &state.pending_samples[begin]);
        }
    return state;
}

bool Film::restore(const FilmState& state) {
    const auto fits = [](const auto& values, const auto& wanted, bool may_be_empty) {
        return values.size() == wanted.size() || (may_be_empty && values.empty());
    };
    if (!fits(state.finished, finished_, false) || !fits(state.finished_samples, finished_samples_, false)
        || !fits(state.pending, pending_, true) || !fits(state.pending_samples, pending_samples_, true))
        return false;
    passes_ = state.passes;
    std::ranges::copy(state.finished, finished_.begin());
    std::ranges::copy(state.finished_samples, finished_samples_.begin());
    std::ranges::copy(state.pending, pending_.begin());
    std::ranges::copy(state.pending_samples, pending_samples_.begin());
    return true;
}

std::uint64_t Film::samples() const {
    return std::accumulate(finished_samples_.begin(), finished_samples_.end(), std::uint64_t{0});
}

Image Film::develop() const {
    Image image{window_.width(), window_.height(), window_, frame_width_, frame_height_, {}, {}};
    std::size_t at = 0;
    for (const LayerSpec* spec : layers_) {
        const std::size_t channels = spec->channels.size();
        Layer layer{spec->name, spec->channels, std::vector<float>(finished_samples_.size() * channels)};
        for (std::size_t pixel = 0; pixel < finished_samples_.size(); ++pixel) {
            const float* sums = &finished_[pixel * channels_ + at];
            const auto n = static_cast<float>(finished_samples_[pixel]);
            for (std::size_t c = 0; c < channels; ++c) {
                float& out = layer.pixels[pixel * channels + c];
                if (spec->develop == Develop::mean) out = n > 0 ? sums[c] / n : 0;
                if (spec->develop == Develop::first || spec->develop == Develop::samples) out = sums[c];
                if (spec->develop == Develop::variance)
                    out = variance_of_mean(sums[c], sums[c + channels], n);
                if (spec->develop == Develop::error) out = relative_error(sums[0], sums[1], sums[2]);
            }
        }
        image.layers.push_back(std::move(layer));
        at += spec->stored();
    }
    return image;
}

}  // namespace relumine
