// SPDX-License-Identifier: Apache-2.0
// Renders that are stopped, in tests.
#pragma once

#include <string>
#include <vector>

#include "tests/render_support.hpp"

namespace relumine::testing {

/// Ends a render after so many reports of progress.
class StopAfter : public RenderObserver {
  public:
    explicit StopAfter(int reports) : reports_(reports) {}
    void progress(const Progress&) override { --reports_; }
    bool stop_requested() override { return reports_ <= 0; }
    void warning(const std::string& text) override { warnings.push_back(text); }
    void finished(const RenderStats& s) override { stats = s; }

    RenderStats stats;
    std::vector<std::string> warnings;

  private:
    int reports_;
};

inline constexpr int no_end = 1 << 30;

/// Several passes of a picture of several tiles, made cheap.
inline RenderSettings small_settings(const std::string& method) {
    RenderSettings settings;
    settings.method = method;
    settings.samples_per_pixel = method == "cache" || method == "block-gather" ? 18 : 5;  // several passes
    settings.width = 36;
    settings.height = 20;
    settings.gather_rays = 16;
    settings.record_size = 16;
    settings.gap_cell = 8;
    settings.glossy_rays = settings.light_samples = method.ends_with("-cache") ? 4 : -1;
    settings.max_depth = 2;
    settings.error = 0.1f;
    settings.radiance = "emission";
    settings.aovs = {"albedo", "position", "direct", "samples", "variance"};
    return settings;
}

}  // namespace relumine::testing
