// SPDX-License-Identifier: Apache-2.0
// Instruction sets, as Highway knows them.
#include "base/instruction_set.hpp"

#include <hwy/targets.h>

#include <algorithm>
#include <array>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "relumine/render.hpp"

namespace relumine {
namespace {

struct Choice {
    const char* name;
    std::int64_t target;  // wider ones have lower bits
};
constexpr std::array choices{Choice{"sse4", HWY_SSE4}, Choice{"avx2", HWY_AVX2}, Choice{"avx512", HWY_AVX3}};

std::string& chosen() {
    static std::string name;
    return name;
}

}  // namespace

std::vector<std::string> instruction_sets() {
    std::vector<std::string> names;
    for (const Choice& choice : choices)
        if ((hwy::SupportedTargets() & HWY_TARGETS & choice.target) != 0) names.emplace_back(choice.name);
    return names;
}

void choose_instruction_set(const std::string& name) {
    const std::vector<std::string> known = instruction_sets();
    if (std::ranges::find(known, name) == known.end())
        throw SettingsError{expected_found(
            "instruction set", known.empty() ? "none: this machine leaves no choice" : one_of(known),
            "\"" + name + "\"" + did_you_mean(name, known))};
    const auto* choice = std::ranges::find_if(choices, [&](const Choice& each) { return name == each.name; });
    hwy::DisableTargets(choice->target - 1);
    chosen() = name;
}

std::string chosen_instruction_set() { return chosen(); }

std::string current_instruction_set() {
    const std::int64_t usable = hwy::SupportedTargets() & HWY_TARGETS;
    return hwy::TargetName(usable & -usable);
}

}  // namespace relumine
