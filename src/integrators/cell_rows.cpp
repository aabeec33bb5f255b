// SPDX-License-Identifier: Apache-2.0
// Tracing rows' records and filling their maps.
#include "integrators/cell_rows.hpp"

#include "base/executor.hpp"
#include "blocks/map_fill.hpp"

namespace relumine {
namespace {

/// What maps are for at a pixel; empty where nothing is.
std::optional<ReceiverBsdf> map_receiver(const GBufferPixel& pixel, float sharp_alpha) {
    if (!pixel.reflects_alone) return {};
    const auto lobes = sharp_lobes(pixel.point->vertex.bsdf, sharp_alpha);
    if (!lobes) return receiver_bsdf(pixel.point->vertex, map_frame);
    if (is_black(lobes->rest)) return {};
    Vertex rest = pixel.point->vertex;
    rest.bsdf = lobes->rest;
    return receiver_bsdf(rest, map_frame);
}

std::vector<BlockPoint> points_of(const CellRow& row, const PixelRect& cell, float sharp_alpha) {
    std::vector<BlockPoint> points;
    for (const auto& samples : row.samples)
        for (int y = cell.y0; y < cell.y1; ++y)
            for (int x = cell.x0; x < cell.x1; ++x) {
                const GBufferPixel& pixel = samples->at(x, y);
                if (const auto receiver = map_receiver(pixel, sharp_alpha))
                    points.push_back({&pixel.cache, *receiver});
            }
    return points;
}

bool touches(const BlockMap& map, const PixelRect& cell) {
    const auto apart = [&](float center, int begin, int end) {
        return center + map.size <= static_cast<float>(begin) || center - map.size >= static_cast<float>(end);
    };
    return !apart(map.center_x, cell.x0, cell.x1) && !apart(map.center_y, cell.y0, cell.y1);
}

}  // namespace

PixelRect CellRow::cell(std::size_t i) const {
    const int x = rect.x0 + static_cast<int>(i) * cell_pixels;
    return {x, rect.y0, std::min(x + cell_pixels, rect.x1), rect.y1};
}

BlockMap CellRows::Store::take() {
    const std::lock_guard lock(mutex_);
    if (maps_.empty()) return {};
    BlockMap map = std::move(maps_.back());
    maps_.pop_back();
    return map;
}

void CellRows::Store::give_back(CellRow& row) {
    const std::lock_guard lock(mutex_);
    for (auto& cell : row.maps)
        for (BlockMap& map : cell) maps_.push_back(std::move(map));
    row.maps.clear();
}

void CellRows::take_in(int y, Preparation& p) {
    rows_.push_back(traced(y, p));
    if (rows_.size() > most) rows_.pop_front();
    if (rows_.size() > 2) fill(rows_.size() - 2, p);
}

const CellRow* CellRows::ready() const { return rows_.size() == most ? &rows_[lit] : nullptr; }

void CellRows::release() {
    rows_[lit].samples.clear();  // others need its records and maps
    store_.give_back(rows_[lit - 1]);
}

/// Empty outside of the frame.
CellRow CellRows::traced(int y, Preparation& p) const {
    constexpr int margin = reach * cell_pixels;
    const View& view = source_.view;
    CellRow row;
    row.rect = intersection({region_.x0 - margin, y, region_.x1 + margin, y + cell_pixels},
                            {0, 0, view.width, view.height});
    if (row.rect.y0 >= row.rect.y1) return row;
    for (std::uint32_t s = p.first_sample; s < p.first_sample + p.sample_count; ++s)
        row.samples.push_back(std::make_unique<GBuffer>(source_.transport, view, row.rect, s,
                                                        PrefixSettings{source_.max_depth, plan_.sharp_alpha},
                                                        source_.surface_layers, p.threads, p.rays));
    row.records.resize(static_cast<std::size_t>((row.rect.width() + cell_pixels - 1) / cell_pixels));
    BlockSettings blocks = plan_.blocks;
    blocks.samples_per_pixel = static_cast<int>(p.sample_count);
    std::mutex mutex;
    parallel_for(p.threads, row.cells(), [&](std::size_t i) {
        if (p.stop()) return;
        RayCounts rays;
        CacheCounts counts;
        {
            const StepTimer timer(counts, CacheStep::create);
            const PixelRect cell = row.cell(i);
            row.records[i] =
                make_records(source_.maps, cell, points_of(row, cell, plan_.sharp_alpha), blocks, rays);
        }
        for (const MapRecord& record : row.records[i]) counts.record_bytes += record.bytes();
        counts.records = row.records[i].size();
        const std::lock_guard lock(mutex);
        p.rays.add(rays);
        p.counts.add(counts);
    });
    return row;
}

/// Makes the maps of rows_[at] from the records of its cells and of those around them.
void CellRows::fill(std::size_t at, Preparation& p) {
    CellRow& row = rows_[at];
    row.maps.resize(row.cells());
    std::mutex mutex;
    parallel_for(p.threads, row.cells(), [&](std::size_t i) {
        if (p.stop()) return;
        CacheCounts counts;
        {
            const StepTimer timer(counts, CacheStep::reproject);
            const std::vector<const MapRecord*> around = records_around(at, i);
            MapFill map_fill(source_.maps.grid, source_.maps.environment);
            for (const MapRecord& record : row.records[i]) {
                if (!record.has_map) continue;
                const auto others = nearest_records(record, around, plan_.reprojected);
                map_fill.run(record, others, source_.maps.radiance.reflects(),
                             row.maps[i].emplace_back(store_.take()));
                counts.reprojections += others.size();
            }
        }
        const std::lock_guard lock(mutex);
        p.counts.add(counts);
    });
}

std::vector<const MapRecord*> CellRows::records_around(std::size_t at, std::size_t cell) const {
    std::vector<const MapRecord*> records;
    if (plan_.reprojected == 0) return records;
    for_cells_around(at, cell, [&](const CellRow& row, std::size_t j) {
        for (const MapRecord& record : row.records[j]) records.push_back(&record);
    });
    return records;
}

std::vector<const BlockMap*> CellRows::maps_around(std::size_t cell) const {
    const PixelRect pixels = intersection(rows_[lit].cell(cell), region_);
    std::vector<const BlockMap*> maps;
    for_cells_around(lit, cell, [&](const CellRow& row, std::size_t j) {
        for (const BlockMap& map : row.maps[j])
            if (touches(map, pixels)) maps.push_back(&map);
    });
    return maps;
}

/// Calls use(row, cell) for a cell and the up to eight around it.
template <typename Use>
void CellRows::for_cells_around(std::size_t at, std::size_t cell, const Use& use) const {
    for (std::size_t r = at - std::min<std::size_t>(at, 1); r <= at + 1 && r < rows_.size(); ++r)
        for (std::size_t j = cell - std::min<std::size_t>(cell, 1); j <= cell + 1 && j < rows_[r].cells();
             ++j)
            use(rows_[r], j);
}

}  // namespace relumine
