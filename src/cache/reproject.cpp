// SPDX-License-Identifier: Apache-2.0
// The reprojection loop: whole rows of bits at a time.
#include "cache/reproject.hpp"

#include "cache/draw_kernel.hpp"

namespace relumine {
namespace {

constexpr float same_normals = 1 - 1e-7f;  // cosine

class RecordReprojector {
  public:
    RecordReprojector(const Record& record, Reprojection& out) : record_(record), out_(out) {
        for (std::size_t y = 0; y < mask_side; ++y) open_.rows[y] = ~out.covered.rows[y];
    }

    void run() {
        const Surfels& s = record_.surfels;
        for (std::size_t layer = 0; layer < s.layers(); ++layer) {
            const bool at_infinity = layer + 1 == s.layers();
            cover(s.layer_begin[layer], s.black_begin[layer], s.layer_begin[layer + 1], at_infinity);
            if (!at_infinity) close_behind(s.layer_begin[layer], s.layer_begin[layer + 1]);
        }
        for (std::size_t y = 0; y < mask_side; ++y)
            out_.covered.rows[y] = ~(open_.rows[y] | out_.unknown.rows[y]);
    }

  private:
    void cover(std::size_t begin, std::size_t black_begin, std::size_t end, bool at_infinity) {
        const std::size_t count = end - begin;
        const RecordTexture texture{record_.radiance,
                                    record_.direct.empty() ? record_.radiance : record_.direct,
                                    static_cast<std::size_t>(record_.side), record_.surfels.missed};
        const Canvas canvas{open_, out_.lit, out_.radiance, out_.direct};
        const auto masks = std::span(out_.masks).subspan(begin, count);
        const auto texels = std::span(record_.surfels.texels).subspan(begin, count);
        const bool any = at_infinity ? draw_missed(masks, texels, texture, canvas)
                                     : draw_surfels(masks, {texels, black_begin - begin}, texture, canvas);
        out_.layers += any ? 1 : 0;
    }

    /// What the move has opened behind this layer: farther layers must not fill it.
    void close_behind(std::size_t begin, std::size_t end) {
        close_trails(std::span(out_.trails).subspan(begin, end - begin), closed_, open_, out_.unknown);
    }

    const Record& record_;
    Reprojection& out_;
    Mask open_;    // neither covered nor unknown
    Mask closed_;  // the trails of the layers so far
};

}  // namespace

Frame receiver_frame(const Frame& record_frame, Vec3 normal) {
    const float cosine = dot(record_frame.n, normal);
    if (cosine > same_normals) return record_frame;
    // Rodrigues' rotation that takes the one normal to the other, applied to a tangent.
    const Vec3 axis = cross(record_frame.n, normal);
    const Vec3 s = record_frame.s * cosine + cross(axis, record_frame.s)
                   + axis * (dot(axis, record_frame.s) / std::max(1 + cosine, 1e-3f));
    const Vec3 tangent = normalize(s - normal * dot(s, normal));
    return {tangent, cross(normal, tangent), normal};
}

void Reprojection::clear(bool with_direct) {
    covered = unknown = lit = Mask{};
    radiance.resize(mask_bits + surfel_padding);
    direct.resize(with_direct ? mask_bits + surfel_padding : 0);
    records = layers = 0;
}

void Reprojection::blacken() {
    for (int y = 0; y < mask_side; ++y)
        for (int x = 0; x < mask_side; ++x) {
            if (lit.test(x, y)) continue;
            const auto at = static_cast<std::size_t>(y * mask_side + x);
            radiance[at] = 0;
            if (!direct.empty()) direct[at] = 0;
        }
}

void reproject(const Record& record, const Receiver& receiver, Reprojection& out) {
    const Surfels& s = record.surfels;
    if (out.masks.size() < s.count + surfel_padding) {
        out.masks.resize(s.count + surfel_padding);
        out.trails.resize(s.count + surfel_padding);
    }
    const bool rotated = !(receiver.frame.s == record.frame.s && receiver.frame.n == record.frame.n);
    const Frame turn{record.frame.to_local({receiver.frame.s}).v, record.frame.to_local({receiver.frame.t}).v,
                     record.frame.to_local({receiver.frame.n}).v};
    const Vec3 shift = receiver.frame.to_local({record.position - receiver.position}).v;
    const std::size_t infinity_begin = s.infinity_begin();
    project_surfels(s, 0, infinity_begin, {turn, shift, rotated, record.side}, out.masks, out.trails);
    const auto masks = std::span(out.masks).subspan(infinity_begin),
               trails = std::span(out.trails).subspan(infinity_begin);
    if (rotated)
        project_surfels(s, infinity_begin, s.count, {turn, {}, true, record.side}, masks, trails);
    else
        place_surfels(s, infinity_begin, s.count, record.side, masks);
    out.unknown = Mask{};
    RecordReprojector(record, out).run();
    ++out.records;
}

}  // namespace relumine
