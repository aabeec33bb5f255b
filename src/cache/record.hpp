// SPDX-License-Identifier: Apache-2.0
// A record: all that one point of a surface sees, as a radiance texture and as surfels in depth layers [V,
// §3.2].
#pragma once

#include <cstdint>
#include <vector>

#include "base/frame.hpp"
#include "cache/hemisphere_samples.hpp"

namespace relumine {

/// A rectangle of texels of the record's texture.
struct TexelRect {
    std::uint8_t u = 0, v = 0, width = 0, height = 0;

    bool operator==(const TexelRect&) const = default;
};

inline constexpr std::size_t corner_planes =
    12;  // x, y, z of the corners (0,0), (1,0), (0,1), (1,1) in (u, v)
inline constexpr std::uint32_t max_surfel_side =
    8;                                             // texels; longer ones bend too much under the square's map
inline constexpr std::size_t surfel_padding = 16;  // surfels may be read this far past their end

/// Rectangular surfels, layer by layer from near to far; the last layer holds what was missed, at infinity.
/// Within a layer those whose texels are all black come last.
struct Surfels {
    float scale = 1;         // metres per unit of `corners`; infinity's are unit directions
    std::size_t count = 0;   // surfels
    std::size_t stride = 0;  // of the planes of `corners`, half floats
    std::vector<std::uint16_t>
        corners;  // corner_planes × stride (+ padding): offsets from the record, in its frame
    std::vector<std::uint8_t> missed;  // side²/8: a bit for each texel at infinity, row-major in (v, u)
    std::vector<TexelRect> texels;     // count (+ padding): which part of the texture the surfel carries
    std::vector<std::uint32_t>
        layer_begin;  // layers + 1 entries; layer k is [layer_begin[k], layer_begin[k + 1])
    std::vector<std::uint32_t> black_begin;  // of each layer

    [[nodiscard]] std::size_t layers() const { return layer_begin.size() - 1; }
    /// The first surfel at infinity.
    [[nodiscard]] std::size_t infinity_begin() const { return layer_begin[layers() - 1]; }
};

struct Record {
    Vec3 position;                        // world space
    Frame frame;                          // n: geometric normal on the viewer's side
    int side = 0;                         // texels along each side of the square
    std::vector<std::uint32_t> radiance;  // side × side (+ padding), row-major in (v, u), RGBE, incident
    std::vector<std::uint32_t> direct;    // the part of it that comes straight from lights; empty: all of it
    Surfels surfels;
    float nearest = 0;            // metres to the nearest hit; infinite where nothing is hit
    float harmonic_distance = 0;  // metres, harmonic mean over the hemisphere; infinite where nothing is hit
    float reach = 0;              // metres: the longest way at which the record may be used

    /// Memory that the record occupies.
    [[nodiscard]] std::size_t bytes() const {
        return sizeof(Record) + 4 * (radiance.capacity() + direct.capacity()) + 2 * surfels.corners.capacity()
               + sizeof(TexelRect) * surfels.texels.capacity() + surfels.missed.capacity()
               + 4 * (surfels.layer_begin.capacity() + surfels.black_begin.capacity());
    }
};

struct RecordSettings {
    int side = 64;    // n: 16, 32, 64 or 128
    int layers = 16;  // K: depth layers of hits, 1 … 64
};

/// How far a record reaches: a share of the harmonic mean distance of what it sees [Ward88], within bounds.
struct ReachLimits {
    float share = 0;            // of the harmonic mean distance
    float least = 0, most = 0;  // metres

    [[nodiscard]] float of(float harmonic_distance) const {
        return std::clamp(share * harmonic_distance, least, most);
    }
};

/// Traces and keeps what `point` sees. The record is a function of its arguments alone. Adds rays of
/// RayPurpose::record and of the radiance source.
[[nodiscard]] Record make_record(const IncidentRadiance& source, const GatherPoint& point,
                                 const RecordSettings& settings, const ReachLimits& reach, std::uint64_t key,
                                 RayCounts& rays);

}  // namespace relumine
