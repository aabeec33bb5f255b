// SPDX-License-Identifier: Apache-2.0
// One point's way through the cache, kept step by step, and what is made of it: pictures and a report.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "base/tile.hpp"
#include "cache/gap_fill.hpp"
#include "cache/lookup.hpp"
#include "cache/shade.hpp"
#include "integrators/gbuffer.hpp"
#include "relumine/image.hpp"

namespace relumine {

/// Shares of the receiver's square, [0, 1].
struct SquareShares {
    float covered = 0, unknown = 0, gaps = 0;  // gaps: neither covered nor unknown
};

struct RecordUse {
    FoundRecord found;
    bool used = false;   // false: those before it left few gaps
    SquareShares after;  // this record and those before it
};

struct InspectedPoint {
    int x = 0, y = 0;           // pixel, full frame
    int width = 0, height = 0;  // of the full frame, pixels
    std::string material;
    GBufferPixel pixel;              // has a point that reflects alone
    RadianceCache cache;             // what `records` point into
    std::vector<RecordUse> records;  // best first, at least one
    Receiver receiver;
    Mask covered, unknown;                   // before gap filling
    std::vector<std::uint32_t> reprojected;  // radiance before gap filling: mask_side², RGBE
    std::vector<GapRay> gap_rays;
    Reprojection filled;
    Reprojection truth;  // traced at the point itself, all bits covered
    BsdfTable bsdf;
    Spectrum estimate, from_truth;             // outgoing radiance of the pixel's sample
    Spectrum error_of_covered, error_of_gaps;  // shares of estimate − from_truth: covered bits, the others

    [[nodiscard]] const Record& best_record() const { return records.front().found.entry->record; }
};

using NamedPicture = std::pair<std::string, Image>;

[[nodiscard]] std::vector<NamedPicture> draw_pictures(const InspectedPoint& point);

/// A JSON object; keys: docs/command.md. Takes the scales from the pictures.
[[nodiscard]] std::string report_json(const InspectedPoint& point, const std::vector<NamedPicture>& pictures);

}  // namespace relumine
