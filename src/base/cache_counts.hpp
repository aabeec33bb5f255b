// SPDX-License-Identifier: Apache-2.0
// What the radiance cache did, for statistics.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>

namespace relumine {

/// The steps of caching whose time is told apart.
enum class CacheStep : std::uint8_t { create, lookup, reproject, shade, gaps, product };
inline constexpr std::array<const char*, 6> cache_step_names{"create", "lookup", "reproject",
                                                             "shade",  "gaps",   "product"};

struct CacheCounts {
    std::uint64_t records = 0, surfels = 0, record_bytes = 0;
    std::uint64_t points = 0;         // shading points whose light came from records
    std::uint64_t reprojections = 0;  // of a record to a point
    std::uint64_t gathered = 0;       // shading points gathered by Monte Carlo: their BSDF transmits
    std::array<std::uint64_t, cache_step_names.size()> nanoseconds{};  // by step, all threads together

    void add(const CacheCounts& other) {
        records += other.records;
        surfels += other.surfels;
        record_bytes += other.record_bytes;
        points += other.points;
        reprojections += other.reprojections;
        gathered += other.gathered;
        for (std::size_t i = 0; i < nanoseconds.size(); ++i) nanoseconds[i] += other.nanoseconds[i];
    }
};

/// Adds the time of its life to a step.
class StepTimer {
  public:
    StepTimer(CacheCounts& counts, CacheStep step)
        : sum_(counts.nanoseconds[static_cast<std::size_t>(step)]) {}
    ~StepTimer() {
        const auto spent = std::chrono::steady_clock::now() - begin_;
        sum_ +=
            static_cast<std::uint64_t>(std::chrono::duration_cast<std::chrono::nanoseconds>(spent).count());
    }
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

  private:
    std::uint64_t& sum_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

}  // namespace relumine
