// SPDX-License-Identifier: Apache-2.0
// Rendering a scene to an image: settings, progress, statistics.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "relumine/image.hpp"
#include "relumine/scene.hpp"

namespace relumine {

/// How the picture is computed; every field has a sensible default. `validate(settings)` states the ranges.
struct RenderSettings {
    std::string method = "cache";           // see render_methods(); "path" is the unbiased reference
    int samples_per_pixel = 16;             // 1 … 2²⁰ camera samples
    std::string pixel_sampling = "jitter";  // "jitter" or "center"
    std::string pixel_filter = "box";       // "box" (one pixel wide) or "blackman-harris" (3 pixels wide)
    std::string sampler = "auto";  // "sobol", "stratified", "independent"; auto: stratified for gather,
                                   // reproject and reproject-mc, else sobol
    int gather_rays = 4096;        // `gather`, `reproject-mc`: rays per shading point, 1 … 2²⁰
    bool gather_packets =
        true;                // `gather`: trace rays sixteen at a time; false: one by one, as the paper did
    int light_samples = -1;  // shadow rays per shading point to the bright part of the light; −1: `gather`
                             // none, `cache` as many as `error` asks for, `irradiance-cache` and
                             // `radiance-cache` 16 per pixel
    int max_depth = -1;      // scattering vertices of a path; −1: unlimited with Russian roulette
    std::string radiance = "auto";  // methods that gather: "emission", "direct", "radiosity", "path"; auto:
                                    // radiosity where light is reflected more than once
    std::string guide = "none";  // `path`, `cache` where `unbiased`: what attracts paths besides their BSDFs:
                                 // "none" or "field", bright surfaces of a radiance field
    int photons = -1;  // methods that use a radiance field: paths from lights for caustics, 0 … 2²⁴; −1: as
                       // many as the method wants, which is none yet. Never where `unbiased`
    int record_size = 64;    // `reproject`, `reproject-mc`, `irradiance-cache`, `radiance-cache`: n, a record
                             // has n × n rays; 16, 32, 64 or 128
    int record_layers = 16;  // the same: K, depth layers of a record, 1 … 64
    float record_spacing = 1;   // the same: factor on how far records are used, 0.01 … 100
    int records_per_point = 3;  // the same: M, the most records that one point uses, 1 … 16
    int gap_cell = 4;           // the same: k, one ray for the gaps of k × k bits; 1, 2, 4 or 8
    float bsdf_share = 0.1f;  // `reproject-mc`: share of the rays drawn from the BSDF, 0 … 1; 0: the paper's
                              // estimator, biased where records see nothing
    float error = 0.02f;          // `cache`: the relative L1 error to aim at, 0.0005 … 0.5
    bool unbiased = false;        // `cache`: the expectation is exact; nothing is filtered
    bool filter_residual = true;  // `cache`: smooth what residual rays find; never where `unbiased`
    int residual_rays = -1;  // `cache`: rays per camera sample for what maps get wrong; −1: as `error` asks
                             // for, shared by all samples of a pixel
    std::vector<std::string>
        without;            // `cache`: parts switched off, to see what they are worth; cache_parts()
    float accuracy = 0.2f;  // `irradiance-cache`, `radiance-cache`: a, up to which error a record is used
                            // [Ward88]; less is more exact and slower, 0.02 … 1
    int glossy_rays = -1;   // the same: rays per camera sample along lobes that records do not hold; −1: 64
                            // per pixel
    int harmonics = 10;     // `radiance-cache`: bands of the harmonics that a record holds, 3 … 16
    std::string cache_scope = "image";  // "image", or "tile": caches of their own for tiles of 64 × 64 pixels
    std::string masking =
        "correlated";           // Smith masking-shadowing of microfacets: "correlated" or "separable"
    std::string camera;         // name or index; "": the first, or a framing one where there is none
    int width = 0, height = 0;  // pixels; 0: what the scene asks for, else 1024 wide by the camera's aspect
    std::optional<PixelRect> crop;  // of the full frame; empty: all of it
    int threads = 0;                // 0: all; never changes the picture
    std::uint64_t seed = 0;
    std::vector<std::string> aovs;  // further layers, see aov_names()
};

/// Names for RenderSettings::method, ::aovs and ::without.
[[nodiscard]] std::vector<std::string> render_methods();
[[nodiscard]] std::vector<std::string> aov_names();
[[nodiscard]] std::vector<std::string> cache_parts();

/// Throws SettingsError naming the first setting that is out of range, what was expected and what was found.
void validate(const RenderSettings& settings);

/// What the radiance cache did.
struct CacheStats {
    std::uint64_t records = 0, surfels = 0, record_bytes = 0;
    std::uint64_t points = 0;         // shading points lit from records
    std::uint64_t reprojections = 0;  // of a record to a point
    std::uint64_t gathered = 0;       // shading points gathered by Monte Carlo, because their BSDF transmits
    std::vector<std::pair<std::string, double>> cpu_seconds;  // by step, all threads together
};

/// The radiance field of `radiance` = "radiosity".
struct FieldStats {
    std::uint64_t elements = 0, links = 0, iterations = 0;
    std::uint64_t bytes = 0;      // while it is used
    double unresolved_links = 0;  // share of the links that led nowhere
};

/// How a render is done. It changes no bit, but limits may end it early, or thin what does not fit.
struct RenderControl {
    double time_limit = 0;            // seconds; then the picture so far is returned. 0: none
    std::uint64_t memory_limit = 0;   // bytes of the whole process; 0: none
    std::string checkpoint;           // file that keeps what is done; "": none
    double checkpoint_interval = 60;  // seconds, ≥ 0; one more is written at the end, however it comes
    bool resume = false;              // go on from the checkpoint; from the beginning where there is none
};

/// Throws SettingsError for a value out of range, OutputError for a checkpoint that stands there and is not
/// to be resumed: it may hold hours of work.
void validate(const RenderControl& control);

/// What checkpoints did for a render.
struct CheckpointStats {
    bool resumed = false;
    std::uint64_t resumed_samples = 0;  // camera samples that earlier runs had finished
    double earlier_seconds = 0;         // that these took, wall clock
    std::uint64_t written = 0, failed = 0;
};

/// What a render did. Counts include what a resumed render had done before; times are wall-clock seconds of
/// this run unless said.
struct RenderStats {
    std::vector<std::pair<std::string, double>> stage_seconds;  // in order: "build", "lights", "render", …
    double total_seconds = 0;
    double cpu_seconds = 0;                     // user + system, all threads
    std::map<std::string, std::uint64_t> rays;  // by purpose: "camera", "shadow", "bounce", "gather", …
    std::uint64_t total_rays = 0;
    std::uint64_t samples = 0;                                    // camera samples
    std::uint64_t non_finite_samples = 0;                         // dropped
    std::uint64_t non_finite_rays = 0;                            // of records and gaps: counted as black
    std::optional<std::array<std::int64_t, 3>> first_non_finite;  // x, y, sample index, to replay it
    std::optional<CacheStats> cache;                              // of methods that keep records
    std::optional<FieldStats> field;                              // where there is one
    std::uint64_t peak_memory_bytes = 0;                          // resident set of the process
    int threads = 0;
    bool stopped = false;                       // fewer samples than wanted
    std::string stopped_by;                     // "": nothing, "observer", "time limit"
    std::optional<CheckpointStats> checkpoint;  // where one was kept
    std::optional<double> predicted_error;      // relative L1, where the layer "error" is asked for

    /// A JSON object with the fields above as keys; documented in docs/statistics.md.
    [[nodiscard]] std::string to_json() const;
};

/// Where a render stands. `total` is in units of work of the stage; 0 while unknown.
struct Progress {
    std::string stage;  // "build", "render", …
    std::uint64_t done = 0, total = 0;
    std::uint64_t rays = 0;    // so far
    double seconds = 0;        // since the render began
    double seconds_left = -1;  // estimate; negative while unknown
};

/// Receives progress. Calls come from worker threads but never two at a time.
class RenderObserver {
  public:
    virtual ~RenderObserver() = default;
    virtual void progress(const Progress&) {}
    virtual void tile_finished(const PixelRect&) {}
    /// Asked often. After `true` the render ends soon with the samples so far, each pixel with the same
    /// number.
    virtual bool stop_requested() { return false; }
    /// Something went wrong that does not end the render. One line.
    virtual void warning(const std::string&) {}
    virtual void finished(const RenderStats&) {}
};

/// Renders the scene. The image is a function of scene, settings and seed alone, to the bit.
/// Throws SettingsError for bad settings (also a camera that does not exist), Error where memory does not
/// suffice.
[[nodiscard]] Image render(const Scene& scene, const RenderSettings& settings = {},
                           RenderObserver* observer = nullptr);

/// The same, kept within limits and safe from interruption. Besides, throws Error where memory_limit does not
/// suffice, FileError for a checkpoint that is damaged or belongs to another scene, other settings or another
/// version, naming the difference. After a whole render the checkpoint holds it all: remove it when the
/// picture is safe.
[[nodiscard]] Image render(const Scene& scene, const RenderSettings& settings, const RenderControl& control,
                           RenderObserver* observer = nullptr);

/// Where in the full frame the picture lies that these settings ask for.
struct PictureFrame {
    int width = 0, height = 0;  // of the full frame, pixels
    PixelRect window;           // the part of it that is rendered
};
/// Throws SettingsError as render does.
[[nodiscard]] PictureFrame picture_frame(const Scene& scene, const RenderSettings& settings);

/// What one camera sample has brought: radiance by scattering vertices, as in the layers of these names.
struct ReplayedSample {
    std::array<float, 3> emission{}, direct{}, indirect{};
    bool finite = true;  // where not, a render drops the sample
};
/// Renders one sample of one pixel of the full frame again. Methods that filter or share work between samples
/// do it as if for this pixel alone: `cache` shows what the sample brings before the filter. Throws
/// SettingsError for a pixel or a sample that the settings do not have, and as render does.
[[nodiscard]] ReplayedSample replay_sample(const Scene& scene, const RenderSettings& settings, int x, int y,
                                           std::uint32_t sample);

/// The vector instructions that can be chosen on this machine, narrow to wide, such as "avx2"; and the
/// choice, which holds for the whole process and must come before anything is rendered. Throws SettingsError
/// for others.
[[nodiscard]] std::vector<std::string> instruction_sets();
void choose_instruction_set(const std::string& name);

/// The library's version, "MAJOR.MINOR.PATCH".
[[nodiscard]] const char* version();

}  // namespace relumine
