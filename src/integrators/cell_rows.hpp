// SPDX-License-Identifier: Apache-2.0
// Rows of cells on their way from camera hits to records to maps.
#pragma once

#include <deque>
#include <memory>
#include <mutex>

#include "blocks/block_partition.hpp"
#include "integrators/cache_plan.hpp"
#include "integrators/gbuffer.hpp"
#include "integrators/integrator.hpp"

namespace relumine {

/// The camera hits of a row of cells, the records that they made, and the maps that they share.
struct CellRow {
    PixelRect rect;
    std::vector<std::unique_ptr<GBuffer>> samples;
    std::vector<std::vector<MapRecord>> records;  // by cell
    std::vector<std::vector<BlockMap>> maps;      // by cell

    [[nodiscard]] std::size_t cells() const { return records.size(); }
    [[nodiscard]] PixelRect cell(std::size_t i) const;
};

/// What rows are made of.
struct CellSource {
    const Transport& transport;
    const View& view;
    bool surface_layers;
    std::uint32_t max_depth;  // of the camera's paths
    MapSource maps;
};

/// The rows that are needed at a time, top to bottom: a pixel needs the maps of the rows beside its own, and
/// these the records of the rows beside theirs.
class CellRows {
  public:
    /// Rows for the pixels of `region`, and two cells around it where the frame is.
    CellRows(const CellSource& source, const CachePlan& plan, const PixelRect& region)
        : source_(source), plan_(plan), region_(region) {}

    /// Rows whose records are held at a time, and rows whose maps are.
    static constexpr std::size_t most = 5, with_maps = 3;
    /// How many rows above its own, and below, a row needs to be lit.
    static constexpr int reach = 2;

    /// Takes in the row of cells from pixel y on. Rows must come one after the other.
    void take_in(int y, Preparation& p);

    /// The row that has all it needs to be lit, `reach` rows above the last; null if there is none yet.
    [[nodiscard]] const CellRow* ready() const;
    /// The maps around a cell of that row that pixels in it may use.
    [[nodiscard]] std::vector<const BlockMap*> maps_around(std::size_t cell) const;
    /// Frees what no other row needs once that row is lit.
    void release();

  private:
    static constexpr std::size_t lit = reach;
    static_assert(most == 2 * reach + 1);

    /// Maps that are not used at the moment, with their memory.
    class Store {
      public:
        [[nodiscard]] BlockMap take();
        void give_back(CellRow& row);

      private:
        std::mutex mutex_;
        std::vector<BlockMap> maps_;
    };

    [[nodiscard]] CellRow traced(int y, Preparation& p) const;
    void fill(std::size_t at, Preparation& p);
    [[nodiscard]] std::vector<const MapRecord*> records_around(std::size_t at, std::size_t cell) const;
    template <typename Use>
    void for_cells_around(std::size_t at, std::size_t cell, const Use& use) const;

    CellSource source_;
    CachePlan plan_;
    PixelRect region_;
    std::deque<CellRow> rows_;
    Store store_;
};

}  // namespace relumine
