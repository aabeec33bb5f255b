// SPDX-License-Identifier: Apache-2.0
// libFuzzer's way into one target, which RELUMINE_FUZZ_TARGET names.
#include <algorithm>
#include <cstddef>

#include "tests/fuzz/fuzz_targets.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace relumine::fuzz;
    static const Target& target = *std::ranges::find(targets(), RELUMINE_FUZZ_TARGET, &Target::name);
    target.run({data, size});
    return 0;
}
