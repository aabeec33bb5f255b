// SPDX-License-Identifier: Apache-2.0
// The body of the public replay_sample(): one camera sample once more.
#include <fmt/format.h>

#include "base/executor.hpp"
#include "base/memory.hpp"
#include "base/message.hpp"
#include "integrators/registry.hpp"
#include "relumine/error.hpp"
#include "relumine/render.hpp"
#include "render_passes.hpp"
#include "render_setup.hpp"

namespace relumine {
namespace {

void check_sample(const RenderSettings& settings, const PictureFrame& frame, int x, int y,
                  std::uint32_t sample) {
    if (x < 0 || y < 0 || x >= frame.width || y >= frame.height)
        throw SettingsError{expected_found("pixel",
                                           fmt::format("0,0 to {},{}", frame.width - 1, frame.height - 1),
                                           fmt::format("{},{}", x, y))};
    if (sample >= static_cast<std::uint32_t>(settings.samples_per_pixel))
        throw SettingsError{expected_found("sample", fmt::format("0 to {}", settings.samples_per_pixel - 1),
                                           fmt::format("{}", sample))};
}

/// Of one pixel, with nothing spread from it to others.
RenderSettings of_pixel(RenderSettings settings, int x, int y) {
    settings.crop = PixelRect{x, y, x + 1, y + 1};
    settings.filter_residual = false;  // the filter works on pixels, not on samples
    return settings;
}

/// What the passes before this one have left, then this one.
void replay_pass(Integrator& integrator, const Pass& pass, const RenderSettings& settings,
                 SampleProbe& probe) {
    Preparation p;
    p.threads = resolve_threads(settings.threads);
    p.stop = [] { return false; };
    if (pass.first_sample > 0) integrator.recover(p);
    p.first_sample = pass.first_sample;
    p.sample_count = pass.sample_count;
    p.probe = &probe;
    integrator.prepare(p);
    const int x = probe.wanted.x, y = probe.wanted.y;
    Tile tile = make_tile({x, y, x + 1, y + 1}, pass.first_sample, pass.sample_count);
    tile.probe = &probe;
    const FlushDenormals flush;
    integrator.render(tile);
}

std::array<float, 3> rgb(const Spectrum& s) { return {s.r, s.g, s.b}; }

}  // namespace

ReplayedSample replay_sample(const Scene& scene, const RenderSettings& settings, int x, int y,
                             std::uint32_t sample) {
    validate(settings);
    check_sample(settings, picture_frame(scene, settings), x, y, sample);
    const RenderSettings replayed = of_pixel(settings, x, y);
    RenderSetup setup(scene.data(), replayed, find_framing(scene.data(), replayed), [](const char*) {});
    RayCounts field_rays;
    if (wants_field(replayed)) setup.add_field(replayed, {}, no_limit, field_rays);
    const auto integrator = make_integrator(replayed, setup.transport, setup.view, false);
    SampleProbe probe{{x, y, sample}, std::nullopt};
    for (const Pass& pass : passes_of(setup.view.samples_per_pixel, *integrator))
        if (sample >= pass.first_sample && sample < pass.first_sample + pass.sample_count)
            replay_pass(*integrator, pass, replayed, probe);
    const SplitRadiance seen = probe.seen.value_or(SplitRadiance{});
    return {rgb(seen.emission), rgb(seen.direct), rgb(seen.indirect), can_be_summed(seen.total())};
}

}  // namespace relumine
