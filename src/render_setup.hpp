// SPDX-License-Identifier: Apache-2.0
// What stands ready before the first pixel: the frame, the tracer, the lights, the view.
#pragma once

#include <functional>

#include "integrators/light_source.hpp"
#include "relumine/render.hpp"

namespace relumine {

/// Which picture settings ask for.
struct Framing {
    const Camera& camera;
    int width, height;  // of the full frame, pixels
    PixelRect window;   // the part of it that is wanted
};

/// Throws SettingsError for a camera that does not exist or a crop outside the frame. Settings are valid.
[[nodiscard]] Framing find_framing(const SceneData& scene, const RenderSettings& settings);

/// Owns what `transport` refers to; `scene` outlives it.
struct RenderSetup {
    /// `begin_stage` hears of "build" and "lights" as they begin.
    RenderSetup(const SceneData& scene, const RenderSettings& settings, const Framing& framing,
                const std::function<void(const char*)>& begin_stage);
    RenderSetup(const RenderSetup&) = delete;
    RenderSetup& operator=(const RenderSetup&) = delete;

    /// Builds the radiance field that `wants_field(settings)` asks for, of at most so many bytes, and the
    /// caustic map beside it. `stop` may be empty.
    void add_field(const RenderSettings& settings, const std::function<bool()>& stop,
                   std::uint64_t most_bytes, RayCounts& rays);

    Tracer tracer;
    LightSampler lights;
    Masking masking;
    UniformBsdfs uniform_bsdfs;
    Transport transport;
    View view;
    std::unique_ptr<CausticMap> caustics;  // or null
    std::unique_ptr<RadianceField> field;  // or null
};

}  // namespace relumine
