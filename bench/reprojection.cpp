// SPDX-License-Identifier: Apache-2.0
// How long reprojection alone takes: the points of a picture with the records that they find, again and
// again.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <string>

#include "base/executor.hpp"
#include "cache/shade.hpp"
#include "integrators/cached_gather.hpp"
#include "integrators/gbuffer.hpp"
#include "integrators/path_tracer.hpp"
#include "render_setup.hpp"

namespace relumine {
namespace {

constexpr std::size_t group = 16;  // points that take turns: their records stay as near as a render's do
constexpr int repeats = 15;

/// A shading point, its records in order, and the least time of each part of all repeats.
struct Point {
    Receiver receiver;
    ReceiverBsdf bsdf;
    std::vector<FoundRecord> records;
    double reproject = infinity, shade = infinity;  // seconds
};

/// What the points' pictures come to, so that no part of the work can be left out unseen.
struct Totals {
    std::size_t reprojections = 0, surfels = 0, covered = 0, unknown = 0;
    Spectrum reflected;
};

/// Its records, and points that use them.
struct Picture {
    RadianceCache cache;
    std::vector<Point> points;
};

Point make_point(const GBufferPixel& pixel, const RadianceCache& cache, const ReuseLimits& reuse) {
    Point point{{pixel.cache.gather.position, pixel.cache.gather.frame}, {}, {}};
    const RadianceCache* const caches = &cache;
    find_records({&caches, 1}, {point.receiver, pixel.cache.x, pixel.cache.y}, reuse, point.records);
    point.receiver.frame = receiver_frame(point.records.front().entry->record.frame, point.receiver.frame.n);
    point.bsdf = *receiver_bsdf(pixel.point->vertex, point.receiver.frame);
    return point;
}

/// Places records for the whole picture and keeps every so manieth pixel's point. The number is prime: the
/// pixels where placement looks for records first, multiples of powers of two, are no likelier than others.
constexpr int every = 251;

Picture make_picture(const RenderSetup& setup, const RenderSettings& settings) {
    RayCounts rays;
    const PixelRect& window = setup.view.window;
    const GBuffer pixels(setup.transport, setup.view, window, 0, {depth_limit(settings)}, false, 1, rays);
    const auto point_at = [&](int x, int y) {
        const GBufferPixel& pixel = pixels.at(x, y);
        return pixel.reflects_alone ? &pixel.cache : nullptr;
    };
    const CacheSettings limits = cache_settings(settings);
    Picture picture;
    PlacementRun run{1, {}, {}, {}};
    place_records(incident_source(settings, setup.transport), window, point_at, limits, RadianceCache(),
                  picture.cache, run);
    int seen = 0;
    for (int y = window.y0; y < window.y1; ++y)
        for (int x = window.x0; x < window.x1; ++x)
            if (pixels.at(x, y).reflects_alone && seen++ % every == 0)
                picture.points.push_back(make_point(pixels.at(x, y), picture.cache, limits.reuse));
    return picture;
}

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// What CachedGather does with a point between lookup and gap rays.
void replay(Point& point, const CacheSettings& settings, Reprojection& incident, BsdfTable& table,
            Totals& totals) {
    CacheCounts counts;
    const double begin = seconds_now();
    cover(point.records, point.receiver, settings, false, incident, counts);
    const double middle = seconds_now();
    totals.reflected += shade(incident, point.bsdf, table, {}).total;
    point.shade = std::min(point.shade, seconds_now() - middle);
    point.reproject = std::min(point.reproject, middle - begin);
    totals.reprojections += counts.reprojections;
    for (std::size_t i = 0; i < counts.reprojections; ++i)
        totals.surfels += point.records[i].entry->record.surfels.count;
    totals.covered += static_cast<std::size_t>(incident.covered.count());
    totals.unknown += static_cast<std::size_t>(incident.unknown.count());
}

Totals replay_all(std::vector<Point>& points, const CacheSettings& settings) {
    Reprojection incident;
    BsdfTable table;
    Totals totals;
    for (std::size_t first = 0; first < points.size(); first += group) {
        Totals again;
        for (int repeat = 0; repeat < repeats; ++repeat)
            for (std::size_t i = first; i < std::min(points.size(), first + group); ++i)
                replay(points[i], settings, incident, table, repeat == 0 ? totals : again);
    }
    return totals;
}

void report(const Picture& picture, const Totals& t) {
    double reproject = 0, shade = 0;
    for (const Point& point : picture.points) {
        reproject += point.reproject;
        shade += point.shade;
    }
    const std::size_t points = picture.points.size(), records = picture.cache.size();
    const auto count = static_cast<double>(points), bits = count * mask_bits;
    fmt::print(
        "points {}, records {}; a point: {:.3f} reprojections, {:.1f} surfels, {:.2f} % covered, {:.2f} % "
        "unknown, "
        "{:.6f} reflected\n",
        points, records, static_cast<double>(t.reprojections) / count, static_cast<double>(t.surfels) / count,
        100 * static_cast<double>(t.covered) / bits, 100 * static_cast<double>(t.unknown) / bits,
        luminance(t.reflected) / static_cast<float>(count));
    fmt::print("µs a point: reproject {:.2f}, BSDF and sum {:.2f}, both {:.2f}\n", 1e6 * reproject / count,
               1e6 * shade / count, 1e6 * (reproject + shade) / count);
}

void run(const std::string& scene_file, const std::string& environment, float rotation) {
    const Scene scene = load_scene(scene_file, {environment, 1, rotation});
    RenderSettings settings;
    settings.method = "reproject";
    settings.radiance = "emission";
    settings.pixel_sampling = "center";
    settings.samples_per_pixel = 1;
    settings.width = settings.height = 512;
    const RenderSetup setup(scene.data(), settings, find_framing(scene.data(), settings), [](const char*) {});
    const FlushDenormals flush;
    Picture picture = make_picture(setup, settings);
    report(picture, replay_all(picture.points, cache_settings(settings)));
}

}  // namespace
}  // namespace relumine

int main(int argc, char** argv) try {
    if (argc != 4) {
        std::fprintf(stderr, "usage: relumine_reprojection SCENE ENVIRONMENT ROTATION_IN_DEGREES\n");
        return 2;
    }
    relumine::run(argv[1], argv[2], std::stof(argv[3]));
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "relumine_reprojection: %s\n", error.what());
    return 1;
}
