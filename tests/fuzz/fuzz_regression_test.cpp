// SPDX-License-Identifier: Apache-2.0
// What fuzzing once found, and the seeds that it begins with, met by every build.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/fuzz/fuzz_targets.hpp"

namespace relumine::fuzz {
namespace {

std::vector<std::uint8_t> bytes_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// Runs what stands in the target's folder; how many files there were.
int run_folder(const Target& target, const std::string& kind) {
    const std::filesystem::path folder =
        std::filesystem::path(RELUMINE_SOURCE_DIR) / "tests/fuzz" / kind / target.name;
    if (!std::filesystem::is_directory(folder)) return 0;
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        SCOPED_TRACE(entry.path().string());
        target.run(bytes_of(entry.path()));
        ++files;
    }
    return files;
}

TEST(Fuzz, SeedsAndRegressionsAreReadOrRefused) {
    for (const Target& target : targets()) {
        EXPECT_GT(run_folder(target, "seeds"), 0) << target.name;
        (void)run_folder(target, "regressions");
    }
}

}  // namespace
}  // namespace relumine::fuzz
