// SPDX-License-Identifier: Apache-2.0
// Filling a map from records: that of its own block, and those around it reprojected.
#pragma once

#include "blocks/block_map.hpp"
#include "blocks/dim_environment.hpp"
#include "blocks/record_projection.hpp"

namespace relumine {

/// The records of `candidates` whose anchors are nearest to that of `record`, which is not among them, and
/// of its depth; at most `most`, in an order that depends on nothing but the records.
[[nodiscard]] std::vector<const MapRecord*> nearest_records(const MapRecord& record,
                                                            std::span<const MapRecord* const> candidates,
                                                            std::size_t most);

/// Fills one map after the other without allocating.
class MapFill {
  public:
    MapFill(const DirectionGrid& grid, const DimEnvironment& environment);

    /// A texel is known if a ray of `record` stands for it or a point of `others` appears in it. It holds the
    /// mean of what is in it; where nothing is, that of the smallest square around it that is not empty,
    /// among the texels that its ray stands for. Of `others` counts what the anchor of `record` sees as
    /// well, as far as its own rays tell: what is not behind the nearest that they have met around that
    /// direction, and the rest where that nearest hardly moves from one anchor to the other. Of each other
    /// record a tile counts as a whole or not at all, or else near things would count more than far ones.
    void run(const MapRecord& record, std::span<const MapRecord* const> others, bool reflects, BlockMap& map);

    /// By texel: how far what `record`'s rays have met is, metres; infinite where nothing is known.
    void distances(const MapRecord& record, std::vector<float>& out) const;

  private:
    /// What is in a texel, or in several.
    struct Sum {
        Spectrum direct, indirect;   // of points, by weight
        Spectrum tint;               // of open directions
        float weight = 0, seen = 0;  // of both, of points

        void add(const Sum& s);
    };

    void find_nearest(const MapRecord& record);
    void add_own(const MapRecord& record);
    void add_other(const MapRecord& other, Vec3 eye);
    void find_hidden(const MapRecord& other, Vec3 eye);
    void add_point(std::uint32_t texel, const SeenRadiance& seen, float weight);
    void add_open(const OpenDirection& open);
    void spread(const MapRecord& record, BlockMap& map) const;
    void spread_run(TexelRun run, BlockMap& map) const;
    void put(std::uint32_t texel, const Sum& sum, BlockMap& map) const;
    [[nodiscard]] Sum sum_of(std::uint32_t first, std::uint32_t count) const;

    const DirectionGrid& grid_;
    const DimEnvironment& environment_;
    std::vector<std::uint32_t> right_, below_;  // by tile: its neighbours
    std::vector<Sum> sums_;                     // by texel
    std::vector<std::uint8_t> hides_;           // by tile: something of the other record may be hidden
    const MapRecord* own_ = nullptr;
    std::vector<std::uint32_t> nearest_;  // by tile: of own_, the nearest met in it and in those around it
    ProjectedPoints projected_;
};

}  // namespace relumine
