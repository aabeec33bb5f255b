// SPDX-License-Identifier: Apache-2.0
// Level-synchronous placement.
#include "cache/placement.hpp"

#include <mutex>

#include "base/executor.hpp"

namespace relumine {
namespace {

/// A record reaches this share of the harmonic mean distance of what it sees…
constexpr float reach_share = 0.35f;
/// …but at least and at most so many pixels.
constexpr float least_reach = 3, most_reach = 24;

/// Levels this coarse are worth measuring gaps for: finer ones would cost a reprojection at every pixel.
constexpr int finest_measured_spacing = 4;

constexpr std::size_t chunk = 16;   // points that one piece of work decides on or makes records for
constexpr std::size_t batch = 256;  // records made before it is seen whether they fit, where room is limited

bool on_coarser_lattice(int x, int y, int spacing) {
    return spacing < level_spacings.front() && x % (2 * spacing) == 0 && y % (2 * spacing) == 0;
}

class Placement {
  public:
    Placement(const IncidentRadiance& source, const PixelRect& region,
              const std::function<const CachePoint*(int, int)>& point_at, const CacheSettings& settings,
              const RadianceCache& kept, RadianceCache& added, PlacementRun& run)
        : source_(source),
          region_(region),
          point_at_(point_at),
          settings_(settings),
          caches_{&kept, &added},
          added_(added),
          run_(run) {}

    void place_level(int spacing) {
        if (run_.room == 0) return;
        std::vector<const CachePoint*> points = lattice_points(spacing);
        std::vector<char> lacks(points.size());  // not vector<bool>: threads write neighbours
        decide(points, spacing, lacks);
        std::size_t wanted = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (lacks[i]) points[wanted++] = points[i];
        points.resize(wanted);
        const std::size_t at_a_time = run_.room == no_limit ? wanted : batch;
        for (std::size_t i = 0; i < wanted && run_.room > 0; i += at_a_time)
            make(std::span(points).subspan(i, std::min(at_a_time, wanted - i)), spacing);
    }

  private:
    [[nodiscard]] std::vector<const CachePoint*> lattice_points(int spacing) const {
        const auto first = [&](int c) { return (c + spacing - 1) / spacing * spacing; };
        std::vector<const CachePoint*> points;
        for (int y = first(region_.y0); y < region_.y1; y += spacing)
            for (int x = first(region_.x0); x < region_.x1; x += spacing) {
                if (on_coarser_lattice(x, y, spacing)) continue;
                if (const CachePoint* point = point_at_(x, y)) points.push_back(point);
            }
        return points;
    }

    void decide(const std::vector<const CachePoint*>& points, int spacing, std::vector<char>& lacks) {
        for_chunks(points.size(), [&](std::size_t begin, std::size_t end, PlacementRun& mine) {
            Reprojection scratch;
            std::vector<FoundRecord> found;
            for (std::size_t i = begin; i < end; ++i)
                lacks[i] = needs_record(*points[i], spacing, scratch, found, mine.counts);
        });
    }

    [[nodiscard]] bool needs_record(const CachePoint& point, int spacing, Reprojection& scratch,
                                    std::vector<FoundRecord>& found, CacheCounts& counts) const {
        const Receiver own{point.gather.position, point.gather.frame};
        {
            const StepTimer timer(counts, CacheStep::lookup);
            find_records(caches_, {own, point.x, point.y}, settings_.reuse, found);
        }
        if (found.empty()) return true;
        if (spacing < finest_measured_spacing) return false;
        const Receiver receiver{own.position, receiver_frame(found.front().entry->record.frame, own.frame.n)};
        return cover(found, receiver, settings_, false, scratch, counts) > settings_.most_gaps;
    }

    void make(std::span<const CachePoint* const> points, int spacing) {
        std::vector<std::optional<CacheEntry>> entries(points.size());
        for_chunks(points.size(), [&](std::size_t begin, std::size_t end, PlacementRun& mine) {
            for (std::size_t i = begin; i < end; ++i)
                entries[i] = make_entry(source_, *points[i], reach_in_spacings * spacing, settings_,
                                        mine.rays, mine.counts);
        });
        for (auto& entry : entries)
            if (entry && fits(entry->record)) added_.add(std::move(*entry));
    }

    /// Takes what the record needs from the room that is left; nothing is left once a record does not fit.
    [[nodiscard]] bool fits(const Record& record) {
        if (run_.room == no_limit) return true;
        const bool fits = record.bytes() <= run_.room;
        run_.room = fits ? run_.room - record.bytes() : 0;
        return fits;
    }

    /// Calls work(begin, end, counters) for chunks of [0, count) on all threads.
    template <typename Work>
    void for_chunks(std::size_t count, const Work& work) {
        parallel_for(run_.threads, (count + chunk - 1) / chunk, [&](std::size_t i) {
            if (run_.stop && run_.stop()) return;
            PlacementRun mine;
            work(i * chunk, std::min(count, (i + 1) * chunk), mine);
            const std::lock_guard lock(mutex_);
            run_.rays.add(mine.rays);
            run_.counts.add(mine.counts);
        });
    }

    const IncidentRadiance& source_;
    const PixelRect& region_;
    const std::function<const CachePoint*(int, int)>& point_at_;
    const CacheSettings& settings_;
    std::array<const RadianceCache*, 2> caches_;
    RadianceCache& added_;
    PlacementRun& run_;
    std::mutex mutex_;
};

}  // namespace

ReachLimits reach_limits(const CachePoint& point, const CacheSettings& settings) {
    return {settings.spacing * reach_share, settings.spacing * least_reach * point.footprint,
            settings.spacing * most_reach * point.footprint};
}

CacheEntry make_entry(const IncidentRadiance& source, const CachePoint& point, int pixel_reach,
                      const CacheSettings& settings, RayCounts& rays, CacheCounts& counts) {
    const StepTimer timer(counts, CacheStep::create);
    CacheEntry entry{
        make_record(source, point.gather, settings.record, reach_limits(point, settings), point.key, rays),
        point.x, point.y, pixel_reach};
    ++counts.records;
    counts.surfels += entry.record.surfels.count;
    counts.record_bytes += entry.record.bytes();
    return entry;
}

float cover(std::span<const FoundRecord> found, const Receiver& receiver, const CacheSettings& settings,
            bool with_direct, Reprojection& out, CacheCounts& counts) {
    const StepTimer timer(counts, CacheStep::reproject);
    out.clear(with_direct);
    float gaps = 1;
    for (const FoundRecord& record : found) {
        reproject(record.entry->record, receiver, out);
        ++counts.reprojections;
        gaps = static_cast<float>(out.gaps()) / mask_bits;
        if (gaps <= settings.enough_gaps) break;
    }
    return gaps;
}

void place_records(const IncidentRadiance& source, const PixelRect& region,
                   const std::function<const CachePoint*(int x, int y)>& point_at,
                   const CacheSettings& settings, const RadianceCache& kept, RadianceCache& added,
                   PlacementRun& run) {
    Placement placement(source, region, point_at, settings, kept, added, run);
    for (const int spacing : level_spacings) {
        if (run.stop && run.stop()) return;
        placement.place_level(spacing);
    }
}

}  // namespace relumine
