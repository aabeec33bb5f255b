// SPDX-License-Identifier: Apache-2.0
// A picture: named layers of float pixels, and how it is read from and written to files.
#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace relumine {

/// A half-open rectangle of pixels: x0 ≤ x < x1, y0 ≤ y < y1, row 0 at the top.
struct PixelRect {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;

    [[nodiscard]] int width() const { return x1 - x0; }
    [[nodiscard]] int height() const { return y1 - y0; }
    [[nodiscard]] bool empty() const { return x1 <= x0 || y1 <= y0; }
    bool operator==(const PixelRect&) const = default;
};

/// One quantity per pixel, such as "albedo" or "depth". The picture itself is the layer with the empty name.
struct Layer {
    std::string name;                   // "" for the picture itself
    std::vector<std::string> channels;  // e.g. {"R", "G", "B"}, {"X", "Y", "Z"}, {"Z"}
    std::vector<float> pixels;          // width × height × channels.size(), interleaved, top row first
};

/// A picture of one or more layers of equal size. Radiance is linear Rec. 709 RGB, W·sr⁻¹·m⁻².
struct Image {
    int width = 0, height = 0;  // of the stored pixels (of the crop, where there is one)
    PixelRect window;           // where they lie in the full frame
    int frame_width = 0, frame_height = 0;
    std::vector<Layer> layers;
    std::map<std::string, std::string> metadata;  // e.g. {"seed", "0"}; written to the headers of EXR files

    /// The layer of that name, or null. The picture itself is `layer("")`.
    [[nodiscard]] const Layer* layer(const std::string& name = "") const;
    /// Linear RGB of a pixel of the picture itself; `x`, `y` count from the stored pixels' corner.
    [[nodiscard]] std::array<float, 3> rgb(int x, int y) const;
};

/// How `write_image` turns radiance into a file.
struct WriteOptions {
    float exposure = 0;  // stops, for PNG: pixels are multiplied by 2^exposure before sRGB encoding
    bool half_floats =
        false;  // for EXR: 16-bit instead of 32-bit RGB layers (positions and depths stay 32-bit)
};

/// Reads `.exr` (all layers), `.pfm`, `.hdr` (linear as stored), `.png` or `.jpg` (sRGB decoded to linear) by
/// content. Throws ImageError when the file is missing, damaged or too large.
[[nodiscard]] Image read_image(const std::string& path);

/// Writes by extension: `.exr` (linear, all layers, metadata), `.png` (exposed, sRGB, dithered; the picture
/// itself alone), `.pfm` (linear; the picture itself alone). The file appears whole or not at all. Throws
/// SettingsError for another extension, OutputError when writing fails.
void write_image(const Image& image, const std::string& path, const WriteOptions& options = {});

}  // namespace relumine
