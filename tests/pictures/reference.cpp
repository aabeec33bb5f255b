// SPDX-License-Identifier: Apache-2.0
// Stored references: the mean and the deviation of samples, and tests of a picture against them.
#include "tests/pictures/reference.hpp"

#include <algorithm>
#include <cmath>

#include "relumine/error.hpp"
#include "tests/statistics.hpp"

namespace relumine::pictures {
namespace {

constexpr int block_side = 4;  // pixels
/// Of a value: half floats are right to 2⁻¹² of it, and the test must not see that.
constexpr double storage_error = 3e-4;

std::string number(double value) { return std::to_string(static_cast<long long>(value)); }

/// Difference and variance of a sum over pixels, one channel.
struct Sum {
    double difference = 0, variance = 0, value = 0;

    [[nodiscard]] double z() const {
        const double deviation = std::hypot(std::sqrt(variance), storage_error * std::abs(value), 1e-7);
        return difference / deviation;
    }
};

/// Sums of all pixels of a rectangle.
Sum sum_over(const PixelRect& pixels, std::size_t channel, const Image& image, double samples,
             const Reference& reference) {
    Sum sum;
    for (int y = pixels.y0; y < pixels.y1; ++y)
        for (int x = pixels.x0; x < pixels.x1; ++x) {
            const auto i = 3 * static_cast<std::size_t>(y * image.width + x) + channel;
            const double expected = reference.mean.layer()->pixels[i], deviation = reference.deviation[i];
            sum.difference += image.layer()->pixels[i] - expected;
            sum.value += expected;
            sum.variance += deviation * deviation * (1 / samples + 1 / reference.samples);
        }
    return sum;
}

void check_shape(const Image& image, const Reference& reference) {
    if (image.width == reference.mean.width && image.height == reference.mean.height
        && image.layer()->pixels.size() == reference.deviation.size())
        return;
    throw ImageError{"picture: expected the size of its reference, found another"};
}

}  // namespace

Reference make_reference(const PictureCase& picture, int samples) {
    const Scene scene = load_picture_scene(picture);
    RenderSettings settings = path_settings(picture);
    settings.samples_per_pixel = std::max(1, samples / reference_batches);
    Reference reference;
    std::vector<double> sums, squares;
    for (int batch = 0; batch < reference_batches; ++batch) {
        settings.seed = first_reference_seed + static_cast<std::uint64_t>(batch);
        reference.mean = render_picture(picture, scene, settings);
        const std::vector<float>& pixels = reference.mean.layer()->pixels;
        sums.resize(pixels.size());
        squares.resize(pixels.size());
        for (std::size_t i = 0; i < pixels.size(); ++i) {
            sums[i] += static_cast<double>(pixels[i]);
            squares[i] += static_cast<double>(pixels[i]) * static_cast<double>(pixels[i]);
        }
    }
    reference.samples = static_cast<double>(reference_batches) * settings.samples_per_pixel;
    std::vector<float>& mean = reference.mean.layers.front().pixels;
    for (std::size_t i = 0; i < mean.size(); ++i) {
        const double m = sums[i] / reference_batches;
        const double variance = std::max(0.0, squares[i] - m * sums[i]) / (reference_batches - 1);
        mean[i] = static_cast<float>(m);
        reference.deviation.push_back(static_cast<float>(std::sqrt(variance * settings.samples_per_pixel)));
    }
    return reference;
}

std::string reference_path(const PictureCase& picture) {
    return std::string(RELUMINE_SOURCE_DIR) + "/tests/pictures/references/" + picture.name + ".exr";
}

void write_reference(const Reference& reference, const std::string& path) {
    Image image = reference.mean;
    image.layers.front().channels = {"R", "G", "B"};
    image.layers.push_back({"deviation", {"R", "G", "B"}, reference.deviation});
    image.metadata = {{"relumine.samples", number(reference.samples)}};
    write_image(image, path, {.half_floats = true});
}

Reference read_reference(const std::string& path) {
    Image image = read_image(path);
    const Layer* deviation = image.layer("deviation");
    const auto samples = image.metadata.find("relumine.samples");
    if (!deviation || samples == image.metadata.end())
        throw ImageError{path + ": expected a reference with a layer \"deviation\", found another picture"};
    Reference reference;
    reference.deviation = deviation->pixels;
    reference.samples = std::stod(samples->second);
    reference.mean = image;
    reference.mean.layers = {*image.layer()};
    return reference;
}

Fit fit(const Image& image, double samples, const Reference& reference) {
    check_shape(image, reference);
    Fit result;
    double comparisons = 0, value = 0, deviation = 0;
    for (std::size_t channel = 0; channel < 3; ++channel) {
        for (int y = 0; y < image.height; y += block_side)
            for (int x = 0; x < image.width; x += block_side) {
                const PixelRect block{x, y, std::min(x + block_side, image.width),
                                      std::min(y + block_side, image.height)};
                const double z = sum_over(block, channel, image, samples, reference).z();
                result.worst_z = std::max(result.worst_z, std::isnan(z) ? 1e9 : std::abs(z));
                ++comparisons;
            }
        const Sum all = sum_over({0, 0, image.width, image.height}, channel, image, samples, reference);
        if (std::abs(all.z()) > std::abs(result.mean_z)) result.mean_z = all.z();
        value += std::abs(all.value);
        deviation += std::sqrt(all.variance);  // channels go together
        ++comparisons;
    }
    result.worst_z = std::max(result.worst_z, std::abs(result.mean_z));
    result.p = -std::expm1(comparisons * std::log1p(-testing::normal_p(result.worst_z)));
    result.mean_error = value > 0 ? deviation / value : 0;
    return result;
}

}  // namespace relumine::pictures
