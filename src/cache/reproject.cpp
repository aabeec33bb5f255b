// SPDX-License-Identifier: Apache-2.0
// The reprojection loop: whole rows of bits at a time.
#include "cache/reproject.hpp"

#include "cache/draw_kernel.hpp"

namespace relumine {
namespace {

constexpr float same_normals = 1 - 1e-7f;  // cosine

class RecordReprojector {
  public:
    RecordReprojector(const Record& record, bool rotated, Reprojection& out)
        : record_(record), rotated_(rotated), out_(out), open_(rest_of(out.covered)) {}

    void run() {
        const Surfels& s = record_.surfels;
        for (std::size_t layer = 0; layer + 1 < s.layers(); ++layer) {
            cover(s.layer_begin[layer], s.black_begin[layer], s.layer_begin[layer + 1]);
            close_behind(s.layer_begin[layer], s.layer_begin[layer + 1]);
        }
        cover_at_infinity();
        Mask lit, open;
        join(lit_, lit);
        join(open_, open);
        join(unknown_, out_.unknown);
        for (std::size_t y = 0; y < mask_side; ++y) {
            out_.lit.rows[y] = out_.lit.rows[y] | lit.rows[y];
            out_.covered.rows[y] = ~(open.rows[y] | out_.unknown.rows[y]);
        }
    }

  private:
    void cover(std::size_t begin, std::size_t black_begin, std::size_t end) {
        const auto masks = std::span(out_.masks).subspan(begin, end - begin);
        const auto texels = std::span(record_.surfels.texels).subspan(begin, end - begin);
        out_.layers += draw_surfels(masks, {texels, black_begin - begin}, texture(), canvas()) ? 1 : 0;
    }

    void cover_at_infinity() {
        const Surfels& s = record_.surfels;
        const std::size_t begin = s.infinity_begin(), count = s.count - begin;
        const bool any = rotated_
                             ? draw_missed(std::span(out_.masks).subspan(begin, count),
                                           std::span(s.texels).subspan(begin, count), texture(), canvas())
                             : copy_missed(texture(), canvas());
        out_.layers += any ? 1 : 0;
    }

    [[nodiscard]] RecordTexture texture() const {
        return {record_.radiance, record_.direct.empty() ? record_.radiance : record_.direct,
                static_cast<std::size_t>(record_.side), record_.surfels.missed};
    }
    [[nodiscard]] Canvas canvas() { return {open_, lit_, out_.radiance, out_.direct}; }

    /// What the move has opened behind this layer: farther layers must not fill it.
    void close_behind(std::size_t begin, std::size_t end) {
        close_trails(std::span(out_.trails).subspan(begin, end - begin), closed_, open_, unknown_);
    }

    const Record& record_;
    bool rotated_;
    Reprojection& out_;
    SplitMask open_;           // neither covered nor unknown
    SplitMask lit_, unknown_;  // by this record
    SplitMask closed_;         // the trails of the layers so far
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
    if (rotated)
        project_surfels(s, infinity_begin, s.count, {turn, {}, true, record.side},
                        std::span(out.masks).subspan(infinity_begin),
                        std::span(out.trails).subspan(infinity_begin));
    RecordReprojector(record, rotated, out).run();
    ++out.records;
}

}  // namespace relumine
