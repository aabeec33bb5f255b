// SPDX-License-Identifier: Apache-2.0
// Mitsuba's own mesh files: a chain of zlib streams, and at the end where each begins.
#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/mitsuba_shapes.hpp"

namespace relumine {
namespace {

constexpr std::uint16_t magic = 0x041C;
constexpr std::uint32_t has_normals = 0x1, has_uvs = 0x2, has_colors = 0x8, single_precision = 0x1000,
                        double_precision = 0x2000;

template <typename T>
T read_at(std::span<const std::uint8_t> bytes, std::size_t offset, const std::string& where) {
    if (offset > bytes.size() || bytes.size() - offset < sizeof(T))
        throw SceneError{expected_found(where, "a whole file", "its end")};
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof(T));
    return value;
}

/// Unpacks a zlib stream as far as it is asked for.
class Unpacked {
  public:
    Unpacked(std::span<const std::uint8_t> packed, const std::string& where)
        : packed_(packed), where_(where) {
        stream_.next_in = const_cast<Bytef*>(packed.data());  // zlib does not write there
        stream_.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), 0xFFFFFFFFu));
        if (inflateInit(&stream_) != Z_OK) throw SceneError{where + ": zlib does not start"};
    }
    ~Unpacked() { inflateEnd(&stream_); }
    Unpacked(const Unpacked&) = delete;
    Unpacked& operator=(const Unpacked&) = delete;

    /// Refuses counts that even the best compression could not have brought into this file.
    void check_count(std::uint64_t count, std::size_t bytes_each, const char* what) const {
        const std::uint64_t most = std::uint64_t{packed_.size()} * 1032 / bytes_each + 1;
        if (count > most || count > 0xFFFFFFF0u)
            throw SceneError{expected_found(where_, fmt::format("{} that the file has room for", what),
                                            fmt::format("{}", count))};
    }
    template <typename T>
    T take() {
        T value;
        read(&value, sizeof(T));
        return value;
    }
    void read(void* to, std::size_t size) {
        auto* out = static_cast<Bytef*>(to);
        while (size > 0) {
            const auto part = static_cast<uInt>(std::min<std::size_t>(size, 1u << 30));
            stream_.next_out = out;
            stream_.avail_out = part;
            const int status = inflate(&stream_, Z_SYNC_FLUSH);
            const std::size_t done = part - stream_.avail_out;
            out += done;
            size -= done;
            if (size > 0 && (status != Z_OK || done == 0))
                throw SceneError{expected_found(where_, "a whole zlib stream", "a damaged one, or its end")};
        }
    }

  private:
    std::span<const std::uint8_t> packed_;
    std::string where_;
    z_stream stream_{};
};

/// `count` groups of numbers, single or double.
template <std::size_t n>
std::vector<std::array<float, n>> numbers(Unpacked& in, std::size_t count, bool doubles) {
    std::vector<std::array<float, n>> values(count);
    if (!doubles) {
        in.read(values.data(), count * sizeof(values[0]));
        return values;
    }
    for (auto& value : values)
        for (float& x : value) x = static_cast<float>(in.take<double>());
    return values;
}

void read_triangles(Unpacked& in, std::size_t count, std::size_t vertices, Mesh& mesh,
                    const std::string& where) {
    mesh.triangles.resize(count);
    for (Triangle& t : mesh.triangles) {
        t.vertex = in.take<std::array<std::uint32_t, 3>>();
        for (const std::uint32_t vertex : t.vertex)
            if (vertex >= vertices)
                throw SceneError{expected_found(where, fmt::format("vertices below {}", vertices),
                                                fmt::format("{}", vertex))};
    }
}

Mesh read_mesh(Unpacked& in, std::uint16_t version, const std::string& where) {
    const auto flags = in.take<std::uint32_t>();
    if (version == 4)
        while (in.take<char>() != '\0') {
        }  // its name
    const bool doubles = (flags & double_precision) != 0;
    if (doubles == ((flags & single_precision) != 0))
        throw SceneError{
            expected_found(where, "single or double precision", fmt::format("flags {:#x}", flags))};
    const auto vertices = in.take<std::uint64_t>(), triangles = in.take<std::uint64_t>();
    in.check_count(vertices, doubles ? 24 : 12, "vertices");
    in.check_count(triangles, 12, "triangles");
    const std::size_t count = vertices;
    Mesh mesh;
    for (const auto& [x, y, z] : numbers<3>(in, count, doubles)) mesh.positions.push_back({x, y, z});
    if (flags & has_normals)
        for (const auto& [x, y, z] : numbers<3>(in, count, doubles)) mesh.normals.push_back({x, y, z});
    if (flags & has_uvs)
        for (const auto& [u, v] : numbers<2>(in, count, doubles)) mesh.uvs[0].push_back({u, v});
    if (flags & has_colors) (void)numbers<3>(in, count, doubles);  // not used by any BSDF that we read
    read_triangles(in, triangles, count, mesh, where);
    return mesh;
}

/// Where stream `shape` begins.
std::size_t offset_of(std::span<const std::uint8_t> bytes, std::size_t shape, std::uint16_t version,
                      const std::string& where) {
    if (shape == 0) return 0;
    const std::size_t entry = version == 4 ? 8 : 4;
    const auto count = read_at<std::uint32_t>(bytes, bytes.size() - 4, where);
    if (shape >= count || std::uint64_t{count} * entry + 4 > bytes.size())
        throw SceneError{
            expected_found(where, fmt::format("a shape_index below {}", count), fmt::format("{}", shape))};
    const std::size_t at = bytes.size() - 4 - (count - shape) * entry;
    return version == 4 ? read_at<std::uint64_t>(bytes, at, where) : read_at<std::uint32_t>(bytes, at, where);
}

}  // namespace

Mesh parse_serialized(std::span<const std::uint8_t> bytes, std::size_t shape, const std::string& where) {
    if (bytes.size() < 8 || read_at<std::uint16_t>(bytes, 0, where) != magic)
        throw SceneError{expected_found(where, "a .serialized file", "another kind of file")};
    const auto version = read_at<std::uint16_t>(bytes, 2, where);
    if (version != 3 && version != 4)
        throw SceneError{expected_found(where, "version 3 or 4 of the format", fmt::format("{}", version))};
    const std::size_t offset = offset_of(bytes, shape, version, where);
    if (read_at<std::uint16_t>(bytes, offset, where) != magic)
        throw SceneError{expected_found(where, "a mesh where the file says", "something else")};
    (void)read_at<std::uint16_t>(bytes, offset + 2, where);
    Unpacked in(bytes.subspan(offset + 4), where);
    return read_mesh(in, version, where);
}

}  // namespace relumine
