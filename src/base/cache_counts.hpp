// SPDX-License-Identifier: Apache-2.0
// What the radiance cache did, for statistics.
#pragma once

#include <array>
#include <cstdint>
#include <ctime>

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

/// CPU time of the calling thread: a busy machine does not show in it, as it would in the time of day.
inline std::uint64_t thread_nanoseconds() {
    std::timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<std::uint64_t>(now.tv_sec) * 1'000'000'000 + static_cast<std::uint64_t>(now.tv_nsec);
}

/// Adds the CPU time of its life to a step.
class StepTimer {
  public:
    StepTimer(CacheCounts& counts, CacheStep step)
        : sum_(counts.nanoseconds[static_cast<std::size_t>(step)]) {}
    ~StepTimer() { sum_ += thread_nanoseconds() - begin_; }
    StepTimer(const StepTimer&) = delete;
    StepTimer& operator=(const StepTimer&) = delete;

  private:
    std::uint64_t& sum_;
    std::uint64_t begin_ = thread_nanoseconds();
};

}  // namespace relumine
