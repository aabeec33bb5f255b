// SPDX-License-Identifier: Apache-2.0
// Unpacking by meshoptimizer, whose decoders are made for untrusted input but believe the sizes that they are
// told.
#include "scene/gltf_meshopt.hpp"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/quote.hpp"

namespace relumine {
namespace {

constexpr std::size_t densest =
    64;  // bytes out of one: a bit for every group of 16 equal differences, in pairs
constexpr std::size_t max_unpacked_bytes = std::size_t{8} << 30;  // all views together

/// The extension's object of one buffer view.
class PackedView {
  public:
    PackedView(const GltfFile& file, std::size_t view, const tinygltf::Value& source);
    [[nodiscard]] std::vector<std::uint8_t> unpack(std::size_t& budget) const;

  private:
    [[noreturn]] void refuse(const std::string& member, const std::string& expected,
                             const std::string& found) const {
        throw SceneError{expected_found(file_.where(place_ + member), expected, found)};
    }
    [[nodiscard]] std::size_t size_of(const char* name) const {
        return source_.Has(name) ? static_cast<std::size_t>(source_.Get(name).GetNumberAsDouble()) : 0;
    }
    [[nodiscard]] std::string text_of(const char* name, const char* fallback) const {
        return source_.Has(name) ? source_.Get(name).Get<std::string>() : fallback;
    }
    [[nodiscard]] std::span<const std::uint8_t> packed_bytes() const;
    void check_mode() const;
    void check_size(std::size_t packed, std::size_t& budget) const;
    [[nodiscard]] int decode(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out) const;
    void filter(std::vector<std::uint8_t>& out) const;

    const GltfFile& file_;
    const tinygltf::Value& source_;
    std::string place_;
    std::size_t count_, stride_, view_length_;
    std::string mode_, filter_;
};

PackedView::PackedView(const GltfFile& file, std::size_t view, const tinygltf::Value& source)
    : file_(file),
      source_(source),
      place_(fmt::format("bufferViews[{}].extensions.EXT_meshopt_compression", view)),
      count_(size_of("count")),
      stride_(size_of("byteStride")),
      view_length_(file.model.bufferViews[view].byteLength),
      mode_(text_of("mode", "")),
      filter_(text_of("filter", "NONE")) {}

std::span<const std::uint8_t> PackedView::packed_bytes() const {
    const auto& buffer = file_.buffers[size_of("buffer")];
    const std::size_t offset = size_of("byteOffset"), length = size_of("byteLength");
    if (offset > buffer.size())
        refuse(".byteOffset", fmt::format("at most {}", buffer.size()), fmt::format("{}", offset));
    if (length > buffer.size() - offset)
        refuse(".byteLength", fmt::format("at most {}", buffer.size() - offset), fmt::format("{}", length));
    return buffer.subspan(offset, length);
}

void PackedView::check_mode() const {
    const bool attributes = mode_ == "ATTRIBUTES";
    if (!attributes && mode_ != "TRIANGLES" && mode_ != "INDICES")
        refuse(".mode", "ATTRIBUTES, TRIANGLES or INDICES", quote(mode_));
    if (attributes ? stride_ % 4 != 0 : stride_ != 2 && stride_ != 4)
        refuse(".byteStride", attributes ? "a multiple of 4" : "2 or 4", fmt::format("{}", stride_));
    if (mode_ == "TRIANGLES" && count_ % 3 != 0)
        refuse(".count", "a multiple of 3", fmt::format("{}", count_));
    const bool fits = filter_ == "NONE" || (filter_ == "OCTAHEDRAL" && (stride_ == 4 || stride_ == 8))
                      || (filter_ == "QUATERNION" && stride_ == 8) || filter_ == "EXPONENTIAL";
    if (!fits || (!attributes && filter_ != "NONE"))
        refuse(".filter", "NONE, OCTAHEDRAL, QUATERNION or EXPONENTIAL, as mode and byteStride allow",
               quote(filter_));
}

void PackedView::check_size(std::size_t packed, std::size_t& budget) const {
    const std::size_t bytes = count_ * stride_;  // below 2^39
    if (bytes != view_length_)
        refuse("", fmt::format("the {} bytes of the view", view_length_),
               fmt::format("{} elements of {} bytes", count_, stride_));
    if (bytes > densest * packed)
        refuse(".count",
               fmt::format("at most {}, what {} bytes can hold", densest * packed / stride_, packed),
               fmt::format("{}", count_));
    if (bytes > budget)
        refuse("", fmt::format("at most {} unpacked bytes in all", max_unpacked_bytes), "more");
    budget -= bytes;
}

int PackedView::decode(std::span<const std::uint8_t> packed, std::vector<std::uint8_t>& out) const {
    if (mode_ == "ATTRIBUTES")
        return meshopt_decodeVertexBuffer(out.data(), count_, stride_, packed.data(), packed.size());
    if (mode_ == "TRIANGLES")
        return meshopt_decodeIndexBuffer(out.data(), count_, stride_, packed.data(), packed.size());
    return meshopt_decodeIndexSequence(out.data(), count_, stride_, packed.data(), packed.size());
}

void PackedView::filter(std::vector<std::uint8_t>& out) const {
    if (filter_ == "OCTAHEDRAL") meshopt_decodeFilterOct(out.data(), count_, stride_);
    if (filter_ == "QUATERNION") meshopt_decodeFilterQuat(out.data(), count_, stride_);
    if (filter_ == "EXPONENTIAL") meshopt_decodeFilterExp(out.data(), count_, stride_);
}

std::vector<std::uint8_t> PackedView::unpack(std::size_t& budget) const {
    const auto packed = packed_bytes();
    check_mode();
    check_size(packed.size(), budget);
    std::vector<std::uint8_t> out(count_ * stride_);
    if (decode(packed, out) != 0) refuse("", fmt::format("packed {}", mode_), "damaged data");
    filter(out);
    return out;
}

}  // namespace

void unpack_gltf_views(GltfFile& file) {
    std::size_t budget = max_unpacked_bytes;
    for (std::size_t i = 0; i < file.model.bufferViews.size(); ++i) {
        const auto& extensions = file.model.bufferViews[i].extensions;
        const auto it = extensions.find("EXT_meshopt_compression");
        if (it == extensions.end()) continue;
        file.unpacked[static_cast<int>(i)] = PackedView{file, i, it->second}.unpack(budget);
    }
}

}  // namespace relumine
