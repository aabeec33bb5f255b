// SPDX-License-Identifier: Apache-2.0
// How many rays were traced, by what they were for.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace relumine {

enum class RayPurpose : std::uint8_t {
    camera,
    prefix,
    gather,
    bounce,
    shadow,
    record,
    gap,
    product,
    residual,
    field,
    photon
};
inline constexpr std::array<const char*, 11> ray_purpose_names{"camera",   "prefix", "gather", "bounce",
                                                               "shadow",   "record", "gap",    "product",
                                                               "residual", "field",  "photon"};

struct RayCounts {
    std::array<std::uint64_t, ray_purpose_names.size()> by_purpose{};
    std::uint64_t non_finite = 0;  // record and gap rays whose radiance was not finite and counts as black

    void add(RayPurpose purpose, std::uint64_t rays = 1) {
        by_purpose[static_cast<std::size_t>(purpose)] += rays;
    }
    void add(const RayCounts& other) {
        for (std::size_t i = 0; i < by_purpose.size(); ++i) by_purpose[i] += other.by_purpose[i];
        non_finite += other.non_finite;
    }
    [[nodiscard]] std::uint64_t total() const {
        std::uint64_t sum = 0;
        for (const std::uint64_t count : by_purpose) sum += count;
        return sum;
    }
};

}  // namespace relumine
