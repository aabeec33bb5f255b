// SPDX-License-Identifier: Apache-2.0
// Rendering small pictures in tests.
#pragma once

#include <string>
#include <vector>

#include "relumine/render.hpp"
#include "tests/statistics.hpp"

namespace relumine::testing {

/// A scene of the project's scenes/ folder; `environment` is a file there, or "".
Scene project_scene(const std::string& name, const std::string& environment = "");

/// Mean over all pixels and channels.
double mean_of(const Image& image);

/// The means of every block of `side` × `side` pixels, all channels together.
std::vector<double> block_means(const Image& image, int side);

/// For each block: mean and standard error over renders with seeds 1 … `seeds`.
std::vector<Estimate> block_estimates(const Scene& scene, RenderSettings settings, int seeds, int side);

/// The least two-sided p-value among pairs of estimates of the same blocks, corrected for their number
/// (Šidák): under the null hypothesis it is below α with probability α. `scale` multiplies the second (to
/// plant a bias).
double agreement_p(const std::vector<Estimate>& a, const std::vector<Estimate>& b, double scale = 1);

}  // namespace relumine::testing
