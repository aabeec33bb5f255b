// SPDX-License-Identifier: Apache-2.0
// What the tests of the command share: a small scene in a folder of its own, and how a run may end.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "run_command.hpp"
#include "tiny_scene.hpp"

namespace relumine::test {

/// A folder with a small scene, and the arguments that render it in no time.
struct Workplace {
    ScratchFolder folder;
    std::string scene = folder / "scene.gltf";
    std::string picture = folder / "out.exr";

    Workplace() { write_bytes(scene, tiny_gltf().dump()); }

    [[nodiscard]] CommandResult render(const std::vector<std::string>& more,
                                       const RunOptions& options = {}) const {
        std::vector<std::string> arguments{"render", scene, "-o", picture};
        for (const auto& [option, value] : {std::pair{"--size", "16x16"}, std::pair{"--spp", "1"}})
            if (std::find(more.begin(), more.end(), option) == more.end())
                arguments.insert(arguments.end(), {option, value});
        arguments.insert(arguments.end(), more.begin(), more.end());
        return run_relumine(arguments, options);
    }
};

inline void expect_one_line(const CommandResult& result, int exit_code, const std::string& words) {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(line_count(result.err), 1u) << result.err;
    EXPECT_NE(result.err.find(words), std::string::npos) << "wanted: " << words << "\nfound: " << result.err;
}

inline void expect_silent_success(const CommandResult& result) {
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
    EXPECT_EQ(result.out, "");
}

}  // namespace relumine::test
