// SPDX-License-Identifier: Apache-2.0
// Running a check on every instruction set.
#pragma once

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace relumine::testing {

/// Runs `check` once for each instruction set that the machine has and the kernels are compiled for.
template <typename Check>
void on_every_target(const Check& check) {
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(target);
        SCOPED_TRACE(hwy::TargetName(target));
        check();
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().DeInit();
}

}  // namespace relumine::testing
