// SPDX-License-Identifier: Apache-2.0
// A first look at an EXR header [OpenEXR, "File layout"].
#include "image/exr_header.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>

#include "image/byte_image.hpp"
#include "image/check.hpp"

namespace relumine {
namespace {

/// Reads little-endian values forward; throws at the end.
class HeaderReader {
  public:
    HeaderReader(std::span<const std::uint8_t> bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    std::span<const std::uint8_t> take(std::size_t count) {
        if (count > bytes_.size())
            fail_image(name_, "a whole EXR header",
                       fmt::format("{} bytes where it asks for {}", bytes_.size(), count));
        const auto taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }
    std::uint32_t take_u32() {
        const auto b = take(4);
        return b[0] | std::uint32_t{b[1]} << 8 | std::uint32_t{b[2]} << 16 | std::uint32_t{b[3]} << 24;
    }
    std::int32_t take_i32() { return static_cast<std::int32_t>(take_u32()); }
    std::string_view take_name() {
        const auto end = std::ranges::find(bytes_, std::uint8_t{0});
        const auto taken = take(static_cast<std::size_t>(end - bytes_.begin()) + 1);
        return {reinterpret_cast<const char*>(taken.data()), taken.size() - 1};
    }
    [[nodiscard]] bool at_end() const { return bytes_.empty(); }

  private:
    std::span<const std::uint8_t> bytes_;
    std::string name_;
};

/// What decides how much memory the file asks for.
struct ExrHeader {
    std::optional<std::int64_t> width, height;  // of the data window, pixels
    std::uint64_t channels = 0;
    std::uint64_t tile_width = 1, tile_height = 1;  // pixels
    int compression = 0;
};

void check_version(std::uint32_t version, const std::string& name) {
    constexpr std::uint32_t deep = 0x800, multi_part = 0x1000, known = 0x1eff;
    if ((version & 0xff) != 2 || (version & ~known) != 0)
        fail_image(name, "EXR version 2", fmt::format("version field {:#x}", version));
    if (version & deep) fail_image(name, "an EXR file of flat pixels", "deep ones");
    if (version & multi_part) fail_image(name, "an EXR file of one part", "several");
}

void read_window(HeaderReader& value, ExrHeader& header) {
    const std::int64_t x0 = value.take_i32(), y0 = value.take_i32(), x1 = value.take_i32(),
                       y1 = value.take_i32();
    header.width = x1 - x0 + 1;
    header.height = y1 - y0 + 1;
}

std::uint64_t count_channels(HeaderReader& value) {
    constexpr std::size_t channel_bytes = 16;  // behind the name: type, linearity, sampling
    std::uint64_t count = 0;
    while (!value.take_name().empty()) {
        (void)value.take(channel_bytes);
        ++count;
    }
    return count;
}

/// OpenEXR reads these types by their own length, whatever length the file says: where the two differ, it
/// goes on at another place than we do, and what we have checked is not what it allocates.
void check_length(std::string_view type, std::span<const std::uint8_t> value, const std::string& name) {
    struct Length {
        std::string_view type;
        std::size_t bytes;
    };
    constexpr std::array lengths{Length{"box2i", 16},
                                 Length{"box2f", 16},
                                 Length{"int", 4},
                                 Length{"float", 4},
                                 Length{"double", 8},
                                 Length{"v2i", 8},
                                 Length{"v2f", 8},
                                 Length{"v2d", 16},
                                 Length{"v3i", 12},
                                 Length{"v3f", 12},
                                 Length{"v3d", 24},
                                 Length{"m33f", 36},
                                 Length{"m33d", 72},
                                 Length{"m44f", 64},
                                 Length{"m44d", 128},
                                 Length{"compression", 1},
                                 Length{"envmap", 1},
                                 Length{"lineOrder", 1},
                                 Length{"deepImageState", 1},
                                 Length{"chromaticities", 32},
                                 Length{"keycode", 28},
                                 Length{"rational", 8},
                                 Length{"timecode", 8},
                                 Length{"tiledesc", 9}};
    const auto* known = std::ranges::find(lengths, type, &Length::type);
    std::uint64_t expected = known == lengths.end() ? value.size() : known->bytes;
    HeaderReader reader(value, name);
    if (type == "preview") {  // its width and height, then four bytes for each pixel
        const std::uint64_t width = reader.take_u32(), height = reader.take_u32();
        expected = width > 0 && height > value.size() / width ? value.size() + 1 : 8 + 4 * width * height;
    }
    if (type == "chlist") {
        (void)count_channels(reader);
        if (!reader.at_end()) expected = 0;
    }
    if (value.size() != expected)
        fail_image(name, fmt::format("an attribute of type {} of its own length", type),
                   fmt::format("{} bytes", value.size()));
}

void read_attribute(std::string_view attribute, HeaderReader& value, ExrHeader& header) {
    if (attribute == "dataWindow") read_window(value, header);
    if (attribute == "channels") header.channels = count_channels(value);
    if (attribute == "compression") header.compression = value.take(1)[0];
    if (attribute == "tiles") {
        header.tile_width = value.take_u32();
        header.tile_height = value.take_u32();
    }
}

ExrHeader read_header(HeaderReader& reader, const std::string& name) {
    ExrHeader header;
    for (std::string_view attribute = reader.take_name(); !attribute.empty();
         attribute = reader.take_name()) {
        const std::string_view type = reader.take_name();
        const auto bytes = reader.take(reader.take_u32());
        check_length(type, bytes, name);
        HeaderReader value(bytes, name);
        read_attribute(attribute, value, header);
    }
    return header;
}

}  // namespace

void check_exr_header(std::span<const std::uint8_t> encoded, const std::string& name) {
    HeaderReader reader(encoded, name);
    (void)reader.take(4);  // magic
    check_version(reader.take_u32(), name);
    const ExrHeader header = read_header(reader, name);
    if (!header.width || !header.height) fail_image(name, "a dataWindow", "none");
    if (header.channels == 0) fail_image(name, "at least one channel", "none");
    check_image_size(*header.width, *header.height, name);

    const std::uint64_t pixels = static_cast<std::uint64_t>(*header.width * *header.height);
    constexpr std::uint64_t max_values = 4 * max_image_pixels;
    if (pixels * header.channels > max_values)
        fail_image(
            name, fmt::format("at most {} values", max_values),
            fmt::format("{} x {} pixels of {} channels", *header.width, *header.height, header.channels));
    constexpr int first_dwa = 8;  // DWAA and later store a block of equal pixels in next to nothing
    if (header.compression < first_dwa) check_packed_size(2 * pixels * header.channels, encoded.size(), name);
    const std::uint64_t max_tile = std::max<std::uint64_t>(pixels, std::uint64_t{1} << 22);
    if (header.tile_width > max_tile || header.tile_height > max_tile
        || header.tile_width * header.tile_height > max_tile)
        fail_image(name, fmt::format("tiles of at most {} pixels", max_tile),
                   fmt::format("{} x {}", header.tile_width, header.tile_height));
}

}  // namespace relumine
