// SPDX-License-Identifier: Apache-2.0
// How large the cells of a radiance field are, and in which order they are made.
#pragma once

#include "radiance/field_trace.hpp"

namespace relumine {

/// Cells for what rays from the seeds have met: their size is a share of how far the median of these rays
/// travels.
[[nodiscard]] CellScale scale_of(const Transport& t, const std::vector<Landing>& landings,
                                 const FieldSettings& settings);

/// Orders landings by cells of this size along a Morton curve: what lies together is made together.
void sort_by_place(std::vector<Landing>& landings, float cell);

}  // namespace relumine
