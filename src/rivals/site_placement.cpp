// SPDX-License-Identifier: Apache-2.0
// Level-synchronous placement of sites.
#include "rivals/site_placement.hpp"

#include <array>
#include <mutex>

#include "base/executor.hpp"

namespace relumine {
namespace {

constexpr std::array lattice_spacings{32, 16, 8, 4, 2, 1, 1, 1, 1};  // pixels
constexpr std::size_t chunk = 16;  // points that one piece of work decides on or makes records for

class SitePlacement {
  public:
    SitePlacement(const PixelRect& frame, const std::function<const SitePoint*(int, int)>& point_at,
                  float share, const SiteMaker& maker, Sites& sites, SiteRun& run)
        : frame_(frame), point_at_(point_at), share_(share), maker_(maker), sites_(sites), run_(run) {}

    /// How many sites it has added.
    std::size_t place_level(int spacing) {
        std::vector<const SitePoint*> points = lattice_points(spacing);
        std::vector<char> lacks(points.size());  // not vector<bool>: threads write neighbours
        for_chunks(points.size(), [&](std::size_t i, SiteRun&) {
            lacks[i] = !sites_.covers(points[i]->position, points[i]->frame.n, share_);
        });
        std::size_t wanted = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
            if (lacks[i]) points[wanted++] = points[i];
        points.resize(wanted);
        make(points);
        return wanted;
    }

  private:
    [[nodiscard]] std::vector<const SitePoint*> lattice_points(int spacing) const {
        std::vector<const SitePoint*> points;
        for (int y = 0; y < frame_.y1; y += spacing)
            for (int x = 0; x < frame_.x1; x += spacing)
                if (const SitePoint* point = point_at_(x, y)) points.push_back(point);
        return points;
    }

    void make(const std::vector<const SitePoint*>& points) {
        const std::size_t first = sites_.size();
        std::vector<Site> made(points.size());
        maker_.grow(first + points.size());
        for_chunks(points.size(), [&](std::size_t i, SiteRun& mine) {
            const StepTimer timer(mine.counts, CacheStep::create);
            made[i] = maker_.make(first + i, *points[i], mine.rays, mine.counts);
        });
        if (!run_.stop || !run_.stop()) sites_.add(made, run_.threads);
    }

    /// Calls work(i, counters) for i in [0, count) on all threads.
    template <typename Work>
    void for_chunks(std::size_t count, const Work& work) {
        parallel_for(run_.threads, (count + chunk - 1) / chunk, [&](std::size_t part) {
            if (run_.stop && run_.stop()) return;
            SiteRun mine;
            for (std::size_t i = part * chunk; i < std::min(count, (part + 1) * chunk); ++i) work(i, mine);
            const std::lock_guard lock(mutex_);
            run_.rays.add(mine.rays);
            run_.counts.add(mine.counts);
        });
    }

    const PixelRect& frame_;
    const std::function<const SitePoint*(int, int)>& point_at_;
    float share_;
    const SiteMaker& maker_;
    Sites& sites_;
    SiteRun& run_;
    std::mutex mutex_;
};

}  // namespace

void place_sites(const PixelRect& frame, const std::function<const SitePoint*(int x, int y)>& point_at,
                 float share, const SiteMaker& maker, Sites& sites, SiteRun& run) {
    SitePlacement placement(frame, point_at, share, maker, sites, run);
    bool every_point = false;  // was looked at and has one
    for (const int spacing : lattice_spacings) {
        if (every_point || (run.stop && run.stop())) return;
        every_point = placement.place_level(spacing) == 0 && spacing == 1;
    }
}

}  // namespace relumine
