// SPDX-License-Identifier: Apache-2.0
// Writing OpenEXR.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>
#include <half.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <list>

#include "image/exr.hpp"
#include "image/exr_names.hpp"
#include "image/exr_stream.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

bool is_colour(const std::string& channel) {
    return channel.size() == 1 && std::string_view("RGBA").find(channel[0]) != std::string_view::npos;
}

/// Half floats end at 65504; a bright but finite pixel stays finite.
half to_half(float value) {
    if (!std::isfinite(value)) return half(value);
    constexpr float largest = 65504;
    return half(std::clamp(value, -largest, largest));
}

/// The picture as OpenEXR wants it described: its header, where the values of each channel lie, and 16-bit
/// copies.
class ExrPicture {
  public:
    ExrPicture(const Image& image, bool half_floats)
        : width_(static_cast<std::size_t>(image.width)),
          window_({image.window.x0, image.window.y0}, {image.window.x1 - 1, image.window.y1 - 1}),
          header_({{0, 0}, {image.frame_width - 1, image.frame_height - 1}}, window_) {
        header_.compression() = Imf::ZIP_COMPRESSION;
        for (const auto& [key, value] : image.metadata) add_metadata(key, value);
        for (const Layer& layer : image.layers)
            for (std::size_t c = 0; c < layer.channels.size(); ++c)
                add_channel(layer, c, half_floats && is_colour(layer.channels[c]));
    }
    [[nodiscard]] const Imf::Header& header() const { return header_; }
    [[nodiscard]] const Imf::FrameBuffer& buffer() const { return buffer_; }
    [[nodiscard]] int rows() const { return window_.max.y - window_.min.y + 1; }

  private:
    void add_metadata(const std::string& key, const std::string& value) {
        constexpr std::size_t longest = 255;  // bytes
        if (key.empty() || key.size() > longest || is_reserved_exr_attribute(key))
            throw SettingsError{fmt::format("metadata: expected a name that EXR allows, found \"{}\"", key)};
        header_.insert(key, Imf::StringAttribute(value));
    }
    void add_channel(const Layer& layer, std::size_t c, bool as_half) {
        const std::string name = exr_channel_name(layer.name, layer.channels[c]);
        if (name.empty() || name.size() > 255 || header_.channels().findChannel(name))
            throw SettingsError{
                fmt::format("layers: expected channels of different names, found \"{}\" again", name)};
        const Imf::PixelType type = as_half ? Imf::HALF : Imf::FLOAT;
        header_.channels().insert(name, Imf::Channel(type));
        const std::size_t step = as_half ? sizeof(half) : layer.channels.size() * sizeof(float);  // bytes
        const void* values = as_half ? halves(layer, c) : static_cast<const void*>(layer.pixels.data() + c);
        buffer_.insert(name, Imf::Slice::Make(type, values, window_, step, width_ * step));
    }
    const void* halves(const Layer& layer, std::size_t c) {
        std::vector<half>& copy = halves_.emplace_back();
        copy.reserve(layer.pixels.size() / layer.channels.size());
        for (std::size_t i = c; i < layer.pixels.size(); i += layer.channels.size())
            copy.push_back(to_half(layer.pixels[i]));
        return copy.data();
    }

    std::size_t width_;  // pixels
    Imath::Box2i window_;
    Imf::Header header_;
    Imf::FrameBuffer buffer_;
    std::list<std::vector<half>> halves_;  // buffer_ points into them
};

}  // namespace

std::vector<std::uint8_t> encode_exr(const Image& image, bool half_floats) {
    try {
        const ExrPicture picture(image, half_floats);
        ExrOutput output;
        {
            Imf::OutputFile file(output, picture.header(), 0);
            file.setFrameBuffer(picture.buffer());
            file.writePixels(picture.rows());
        }  // writes the table of rows
        return output.take_bytes();
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {
        throw OutputError{fmt::format("EXR: {}", error.what())};
    }
}

}  // namespace relumine
