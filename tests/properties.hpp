// SPDX-License-Identifier: Apache-2.0
// Properties of random things by RapidCheck, from a fixed seed: RC_PARAMS="seed=N max_success=N" takes
// another.
#pragma once

#include <rapidcheck.h>

#include <cstdlib>
#include <string>

namespace relumine::testing {

/// In [0, 1), and shrinks to 0; for use within properties.
inline float unit_number() {
    constexpr int steps = 1 << 20;
    return static_cast<float>(*rc::gen::inRange(0, steps)) / steps;
}
inline float within(float low, float high) { return low + (high - low) * unit_number(); }

/// Whether the property holds for a few hundred random cases; says on stderr for which it does not.
template <typename Property>
bool holds(const std::string& description, Property&& property) {
    setenv("RC_PARAMS", "seed=1 max_success=300 verbose_progress=0", 0);  // read at first use
    return rc::check(description, std::forward<Property>(property));
}

}  // namespace relumine::testing
