// SPDX-License-Identifier: Apache-2.0
// The body of the public render(): ties scene, tracer, integrator and film together.
#include "relumine/render.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <mutex>

#include "base/executor.hpp"
#include "base/message.hpp"
#include "film/film.hpp"
#include "integrators/registry.hpp"
#include "relumine/error.hpp"
#include "shading/material.hpp"

namespace relumine {
namespace {

constexpr int tile_side = 16;               // pixels; a multiple of the packets' blocks
constexpr int default_width = 1024;         // pixels
constexpr std::uint32_t longest_pass = 64;  // samples per pixel

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
    [[nodiscard]] RenderStats stats(int threads) {
        end_stage();
        RenderStats stats;
        stats.stage_seconds = stages_;
        stats.total_seconds = seconds();
        stats.cpu_seconds = cpu_seconds() - cpu_begin_;
        for (std::size_t i = 0; i < ray_purpose_names.size(); ++i)
            stats.rays[ray_purpose_names[i]] = rays_.by_purpose[i];
        stats.total_rays = rays_.total();
        stats.non_finite_samples = non_finite_;
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
    RayCounts rays_;
    std::uint64_t non_finite_ = 0;
    std::optional<NonFiniteSample> first_non_finite_;
    std::atomic<bool> stopped_ = false;
};

const Camera& find_camera(const SceneData& scene, const std::string& wanted) {
    if (wanted.empty()) return scene.cameras.front();
    std::vector<std::string> names;
    for (const Camera& camera : scene.cameras) {
        if (camera.name == wanted) return camera;
        names.push_back(camera.name);
    }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (error == std::errc{} && end == wanted.data() + wanted.size() && number < scene.cameras.size())
        return scene.cameras[number];
    throw SettingsError{expected_found("camera",
                                       fmt::format("{} or an index below {}", one_of(names), names.size()),
                                       "\"" + wanted + "\"" + did_you_mean(wanted, names))};
}

struct FrameSize {
    int width, height;
};

FrameSize frame_size(const RenderSettings& settings, const Camera& camera) {
    if (settings.width > 0) return {settings.width, settings.height};
    const double aspect = camera.aspect > 0 ? camera.aspect : 4.0 / 3.0;
    return {default_width, std::clamp(static_cast<int>(std::lround(default_width / aspect)), 1, 65536)};
}

PixelRect crop_window(const RenderSettings& settings, FrameSize frame) {
    const PixelRect whole{0, 0, frame.width, frame.height};
    if (!settings.crop) return whole;
    const PixelRect& c = *settings.crop;
    if (!c.empty() && c.x0 >= 0 && c.y0 >= 0 && c.x1 <= frame.width && c.y1 <= frame.height) return c;
    throw SettingsError{expected_found("crop",
                                       fmt::format("a rectangle inside 0 0 {} {}", frame.width, frame.height),
                                       fmt::format("{} {} {} {}", c.x0, c.y0, c.x1, c.y1))};
}

PointSet point_set(const RenderSettings& s) {
    if (s.sampler == "stratified") return PointSet::stratified;
    if (s.sampler == "independent") return PointSet::independent;
    return s.sampler == "auto" && s.method == "gather" ? PointSet::stratified : PointSet::sobol;
}

PixelFilterKind pixel_filter(const RenderSettings& s) {
    if (s.pixel_sampling == "center") return PixelFilterKind::center;
    return s.pixel_filter == "box" ? PixelFilterKind::box : PixelFilterKind::blackman_harris;
}

View make_view(const RenderSettings& s, const Camera& camera, FrameSize frame) {
    return {CameraRays(camera, frame.width, frame.height), PixelFilter(pixel_filter(s)), point_set(s), s.seed,
            static_cast<std::uint32_t>(s.samples_per_pixel)};
}

/// The crop cut along the full frame's multiples of the tile side, row by row.
std::vector<PixelRect> tiles_of(const PixelRect& window) {
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
std::vector<Pass> passes_of(std::uint32_t samples) {
    std::vector<Pass> passes;
    for (std::uint32_t done = 0; done < samples;) {
        const std::uint32_t count = std::min({std::max(1u, done), longest_pass, samples - done});
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

void render_passes(const Integrator& integrator, const PixelRect& window, std::uint32_t samples, int threads,
                   Film& film, Monitor& monitor) {
    const std::vector<PixelRect> tiles = tiles_of(window);
    monitor.begin_stage("render", work_of(window, {0, samples}));
    for (const Pass& pass : passes_of(samples)) {
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
    const Camera& camera = find_camera(data, settings.camera);
    const FrameSize frame = frame_size(settings, camera);
    const PixelRect window = crop_window(settings, frame);
    const int threads = resolve_threads(settings.threads);

    Monitor monitor(observer);
    monitor.begin_stage("build");
    const auto opacity_at = [&data](const Hit& hit) {
        const Mesh& mesh = data.meshes[index(data.instances[hit.instance].mesh)];
        return opacity(data, data.materials[index(mesh.material)], texture_coordinates(mesh, hit));
    };
    const Tracer tracer(data, opacity_at);
    monitor.begin_stage("lights");
    const LightSampler lights(data, {});
    const Masking masking = settings.masking == "separable" ? Masking::separable : Masking::correlated;
    const UniformBsdfs uniform_bsdfs(data, masking);
    const Transport transport{data, tracer, lights, uniform_bsdfs, masking};
    const View view = make_view(settings, camera, frame);
    const auto integrator = make_integrator(settings, transport, view, needs_surfaces(settings.aovs));

    Film film(frame.width, frame.height, window, settings.aovs);
    render_passes(*integrator, window, view.samples_per_pixel, threads, film, monitor);
    Image image = film.develop();
    RenderStats stats = monitor.stats(threads);
    stats.samples = film.samples();
    describe(image, settings, stats);
    if (observer) observer->finished(stats);
    return image;
}

const char* version() { return RELUMINE_VERSION; }

}  // namespace relumine
