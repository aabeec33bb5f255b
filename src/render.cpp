// SPDX-License-Identifier: Apache-2.0
// The body of the public render(): ties scene, tracer, integrator and film together.
#include "relumine/render.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <mutex>

#include "base/executor.hpp"
#include "film/film.hpp"
#include "integrators/light_source.hpp"
#include "integrators/registry.hpp"
#include "render_setup.hpp"

namespace relumine {
namespace {

double cpu_seconds() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    const auto seconds = [](const timeval& t) {
        return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
    };
    return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

std::uint64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

CacheStats cache_stats(const CacheCounts& c) {
    CacheStats stats{c.records, c.surfels, c.record_bytes, c.points, c.reprojections, c.gathered, {}};
    for (std::size_t i = 0; i < cache_step_names.size(); ++i)
        stats.cpu_seconds.emplace_back(cache_step_names[i], 1e-9 * static_cast<double>(c.nanoseconds[i]));
    return stats;
}

FieldStats field_stats(const FieldFigures& f) {
    return {f.elements, f.links, f.iterations, f.bytes, f.unresolved};
}

/// Measures stages and passes progress on; calls to the observer never overlap.
class Monitor {
  public:
    explicit Monitor(RenderObserver* observer) : observer_(observer) {}

    void begin_stage(const std::string& name, std::uint64_t total = 0) {
        end_stage();
        stage_ = {name, 0, total, rays_.total(), seconds(), -1};
        stage_begin_ = seconds();
        if (observer_) observer_->progress(stage_);
    }
    void end_stage() {
        if (!stage_.stage.empty()) stages_.emplace_back(stage_.stage, seconds() - stage_begin_);
        stage_.stage.clear();
    }
    /// Whether the observer wants the render to end; remembers it.
    bool stop() {
        if (!observer_ || stopped_) return stopped_;
        const std::lock_guard lock(mutex_);
        if (observer_->stop_requested()) stopped_ = true;
        return stopped_;
    }
    void finish_tile(const Tile& tile, std::uint64_t work) {
        const std::lock_guard lock(mutex_);
        rays_.add(tile.rays);
        cache_.add(tile.cache);
        non_finite_ += tile.non_finite;
        keep_first(tile);
        stage_.done += work;
        if (!observer_) return;
        stage_.rays = rays_.total();
        stage_.seconds = seconds();
        const double spent = stage_.seconds - stage_begin_;
        stage_.seconds_left =
            spent * static_cast<double>(stage_.total - stage_.done) / static_cast<double>(stage_.done);
        observer_->tile_finished(tile.rect);
        observer_->progress(stage_);
    }
    /// Runs what goes before a pass; its time counts as a stage of its own.
    template <typename Work>
    void prepare(Preparation& p, const Work& work) {
        const double begin = seconds();
        work();
        preparation_seconds_ += seconds() - begin;
        const std::lock_guard lock(mutex_);
        rays_.add(p.rays);
        cache_.add(p.counts);
    }
    void add(const RayCounts& rays) {
        const std::lock_guard lock(mutex_);
        rays_.add(rays);
    }
    [[nodiscard]] RenderStats stats(int threads) {
        end_stage();
        RenderStats stats;
        stats.stage_seconds = stages_;
        if (cache_.points + cache_.gathered > 0) {
            stats.stage_seconds.back().second -= preparation_seconds_;
            stats.stage_seconds.insert(stats.stage_seconds.end() - 1, {"records", preparation_seconds_});
            stats.cache = cache_stats(cache_);
        }
        stats.total_seconds = seconds();
        stats.cpu_seconds = cpu_seconds() - cpu_begin_;
        for (std::size_t i = 0; i < ray_purpose_names.size(); ++i)
            stats.rays[ray_purpose_names[i]] = rays_.by_purpose[i];
        stats.total_rays = rays_.total();
        stats.non_finite_samples = non_finite_;
        stats.non_finite_rays = rays_.non_finite;
        if (first_non_finite_)
            stats.first_non_finite = {first_non_finite_->x, first_non_finite_->y, first_non_finite_->sample};
        stats.peak_memory_bytes = peak_memory_bytes();
        stats.threads = threads;
        stats.stopped = stopped_;
        return stats;
    }

  private:
    [[nodiscard]] double seconds() const {
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
    }
    /// The first in order of sample, row, column, so that it does not depend on which thread was first.
    void keep_first(const Tile& tile) {
        if (!tile.first_non_finite) return;
        const auto order = [](const NonFiniteSample& s) { return std::tuple(s.sample, s.y, s.x); };
        if (!first_non_finite_ || order(*tile.first_non_finite) < order(*first_non_finite_))
            first_non_finite_ = tile.first_non_finite;
    }

    RenderObserver* observer_;
    std::mutex mutex_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double cpu_begin_ = cpu_seconds();
    Progress stage_;
    double stage_begin_ = 0;
    std::vector<std::pair<std::string, double>> stages_;
    double preparation_seconds_ = 0;
    RayCounts rays_;
    CacheCounts cache_;
    std::uint64_t non_finite_ = 0;
    std::optional<NonFiniteSample> first_non_finite_;
    std::atomic<bool> stopped_ = false;
};

/// The crop cut along the full frame's multiples of the tile side, row by row.
std::vector<PixelRect> tiles_of(const PixelRect& window, int tile_side) {
    std::vector<PixelRect> tiles;
    for (int y = window.y0 / tile_side * tile_side; y < window.y1; y += tile_side)
        for (int x = window.x0 / tile_side * tile_side; x < window.x1; x += tile_side)
            tiles.push_back({std::max(x, window.x0), std::max(y, window.y0),
                             std::min(x + tile_side, window.x1), std::min(y + tile_side, window.y1)});
    return tiles;
}

struct Pass {
    std::uint32_t first_sample, sample_count;
};

/// Passes of 1, 1, 2, 4, … samples, so that there is soon something to see and to save.
std::vector<Pass> passes_of(std::uint32_t samples, std::uint32_t shortest_pass, std::uint32_t longest_pass) {
    std::vector<Pass> passes;
    for (std::uint32_t done = 0; done < samples;) {
        const std::uint32_t count = std::min({std::max(shortest_pass, done), longest_pass, samples - done});
        passes.push_back({done, count});
        done += count;
    }
    return passes;
}

std::uint64_t work_of(const PixelRect& tile, const Pass& pass) {
    return static_cast<std::uint64_t>(tile.width()) * static_cast<std::uint64_t>(tile.height())
           * pass.sample_count;
}

/// One pass over all tiles; false where it was stopped on the way.
bool render_pass(const Integrator& integrator, const std::vector<PixelRect>& tiles, const Pass& pass,
                 int threads, Film& film, Monitor& monitor) {
    parallel_for(threads, tiles.size(), [&](std::size_t i) {
        if (monitor.stop()) return;
        Tile tile = make_tile(tiles[i], pass.first_sample, pass.sample_count);
        integrator.render(tile);
        film.add(tile);
        monitor.finish_tile(tile, work_of(tiles[i], pass));
    });
    return !monitor.stop();
}

void render_passes(Integrator& integrator, const PixelRect& window, std::uint32_t samples, int threads,
                   Film& film, Monitor& monitor) {
    const std::vector<PixelRect> tiles = tiles_of(window, integrator.tile_side());
    monitor.begin_stage("render", work_of(window, {0, samples}));
    for (const Pass& pass : passes_of(samples, integrator.shortest_pass(), integrator.longest_pass())) {
        Preparation preparation{
            pass.first_sample, pass.sample_count, threads, [&] { return monitor.stop(); }, {}, {}};
        monitor.prepare(preparation, [&] { integrator.prepare(preparation); });
        const bool whole = render_pass(integrator, tiles, pass, threads, film, monitor);
        if (whole || !film.has_passes())
            film.finish_pass();  // stopped in the first pass: better some tiles than none
        if (!whole) break;
    }
    monitor.end_stage();
}

void describe(Image& image, const RenderSettings& settings, const RenderStats& stats) {
    image.metadata["relumine.version"] = version();
    image.metadata["relumine.method"] = settings.method;
    image.metadata["relumine.seed"] = std::to_string(settings.seed);
    image.metadata["relumine.samples_per_pixel"] = std::to_string(settings.samples_per_pixel);
    image.metadata["relumine.samples"] = std::to_string(stats.samples);
    image.metadata["relumine.seconds"] = fmt::format("{:.3f}", stats.total_seconds);
}

}  // namespace

Image render(const Scene& scene, const RenderSettings& settings, RenderObserver* observer) {
    validate(settings);
    const SceneData& data = scene.data();
    const Framing framing = find_framing(data, settings);
    const int threads = resolve_threads(settings.threads);

    Monitor monitor(observer);
    RenderSetup setup(data, settings, framing, [&](const char* stage) { monitor.begin_stage(stage); });
    std::unique_ptr<RadianceField> field;
    if (wants_field(settings)) {
        RayCounts rays;
        monitor.begin_stage("field");
        field = make_field(
            settings, setup.transport, setup.view, [&] { return monitor.stop(); }, rays);
        monitor.add(rays);
        setup.transport.field = field.get();
    }
    const auto integrator =
        make_integrator(settings, setup.transport, setup.view, needs_surfaces(settings.aovs));

    Film film(framing.width, framing.height, framing.window, settings.aovs);
    render_passes(*integrator, framing.window, setup.view.samples_per_pixel, threads, film, monitor);
    Image image = film.develop();
    RenderStats stats = monitor.stats(threads);
    stats.samples = film.samples();
    if (field) stats.field = field_stats(field->figures());
    describe(image, settings, stats);
    if (observer) observer->finished(stats);
    return image;
}

const char* version() { return RELUMINE_VERSION; }

}  // namespace relumine
