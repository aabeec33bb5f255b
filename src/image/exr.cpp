// SPDX-License-Identifier: Apache-2.0
// Reading OpenEXR.
#include "image/exr.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <exception>
#include <map>
#include <string_view>

#include "image/check.hpp"
#include "image/exr_header.hpp"
#include "image/exr_names.hpp"
#include "image/exr_stream.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

/// Names of channels by layer; the picture itself, "", comes first.
using ChannelsOfLayer = std::map<std::string, std::vector<std::string>>;

/// Red, green, blue; whatever else in alphabetical order; alpha.
void sort_channels(std::vector<std::string>& channels) {
    constexpr std::array<std::string_view, 3> first = {"R", "G", "B"};
    const auto rank = [&](const std::string& channel) {
        return channel == "A" ? first.size() + 1
                              : static_cast<std::size_t>(std::ranges::find(first, channel) - first.begin());
    };
    std::ranges::stable_sort(channels, {}, rank);
}

void check_sampling(const char* channel, const Imf::Channel& stored, const std::string& name) {
    if (stored.xSampling == 1 && stored.ySampling == 1) return;
    fail_image(
        name, "channels of full resolution",
        fmt::format("one value of \"{}\" for {} x {} pixels", channel, stored.xSampling, stored.ySampling));
}

ChannelsOfLayer channels_of_layers(const Imf::ChannelList& stored, const std::string& name) {
    ChannelsOfLayer layers;
    for (auto it = stored.begin(); it != stored.end(); ++it) {
        check_sampling(it.name(), it.channel(), name);
        const std::string full = it.name();
        const std::size_t dot = full.rfind('.');
        if (dot == std::string::npos)
            layers[""].push_back(full);
        else
            layers[full.substr(0, dot)].push_back(full.substr(dot + 1));
    }
    for (auto& [layer, channels] : layers) sort_channels(channels);
    return layers;
}

std::map<std::string, std::string> metadata_of(const Imf::Header& header) {
    std::map<std::string, std::string> metadata;
    for (auto it = header.begin(); it != header.end(); ++it)
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
            if (!is_reserved_exr_attribute(it.name())) metadata[it.name()] = text->value();
    return metadata;
}

/// An image of the right size and layers, still black.
Image empty_image(const Imf::Header& header, const std::string& name) {
    const Imath::Box2i& data = header.dataWindow();
    const Imath::Box2i& display = header.displayWindow();
    Image image;
    image.width = data.max.x - data.min.x + 1;
    image.height = data.max.y - data.min.y + 1;
    const int x0 = data.min.x - display.min.x, y0 = data.min.y - display.min.y;
    image.window = {x0, y0, x0 + image.width, y0 + image.height};
    image.frame_width = display.max.x - display.min.x + 1;
    image.frame_height = display.max.y - display.min.y + 1;
    const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    for (auto& [layer, channels] : channels_of_layers(header.channels(), name))
        image.layers.push_back({layer, channels, std::vector<float>(pixels * channels.size())});
    image.metadata = metadata_of(header);
    return image;
}

/// Where OpenEXR shall put each channel, converted to float.
Imf::FrameBuffer frame_buffer(Image& image, const Imath::Box2i& data_window) {
    Imf::FrameBuffer buffer;
    for (Layer& layer : image.layers) {
        const std::size_t x_stride = layer.channels.size() * sizeof(float);
        const std::size_t y_stride = static_cast<std::size_t>(image.width) * x_stride;
        for (std::size_t c = 0; c < layer.channels.size(); ++c)
            buffer.insert(
                exr_channel_name(layer.name, layer.channels[c]),
                Imf::Slice::Make(Imf::FLOAT, layer.pixels.data() + c, data_window, x_stride, y_stride));
    }
    return buffer;
}

/// Windows are boxes of ints with both ends inside; keeps sums of their corners far from overflow.
void check_windows(const Imf::Header& header, const std::string& name) {
    constexpr int limit = 1 << 28;
    const auto inside = [](const Imath::V2i& p) { return std::max(std::abs(p.x), std::abs(p.y)) < limit; };
    const Imath::Box2i& data = header.dataWindow();
    const Imath::Box2i& display = header.displayWindow();
    if (!inside(data.min) || !inside(data.max) || !inside(display.min) || !inside(display.max))
        fail_image(name, fmt::format("windows within {} pixels of the origin", limit), "a corner outside");
}

Image decode(std::span<const std::uint8_t> encoded, const std::string& name) {
    ExrInput input(encoded, name);
    Imf::InputFile file(input, 0);
    const Imf::Header& header = file.header();
    check_windows(header, name);
    Image image = empty_image(header, name);
    file.setFrameBuffer(frame_buffer(image, header.dataWindow()));
    file.readPixels(header.dataWindow().min.y, header.dataWindow().max.y);
    return image;
}

}  // namespace

bool is_exr(std::span<const std::uint8_t> bytes) { return starts_with(bytes, "\x76\x2f\x31\x01"); }

Image decode_exr(std::span<const std::uint8_t> encoded, const std::string& name) {
    check_exr_header(encoded, name);
    try {
        return decode(encoded, name);
    } catch (const Error&) {
        throw;
    } catch (const std::exception& error) {  // OpenEXR's own, or no memory for what it asks
        fail_image(name, "an undamaged EXR file", error.what());
    }
}

}  // namespace relumine
