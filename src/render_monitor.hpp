// SPDX-License-Identifier: Apache-2.0
// Watches a render: stages, counts, limits; passes progress on to the observer.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>

#include "base/work_done.hpp"
#include "integrators/integrator.hpp"
#include "relumine/render.hpp"

namespace relumine {

enum class StopReason : std::uint8_t { none, observer, time, memory };

/// Bytes of this process that are in memory now; 0 where the system does not tell.
[[nodiscard]] std::uint64_t resident_bytes();

/// Measures stages, passes progress on, and says when to stop. Calls to the observer never overlap.
class Monitor {
  public:
    Monitor(RenderObserver* observer, const RenderControl& control);

    /// `done` of `total` units of work have been done before.
    void begin_stage(const std::string& name, std::uint64_t total = 0, std::uint64_t done = 0);
    void end_stage();

    /// Whether the render is to end: the observer wants it, or a limit is reached. Remembers it.
    [[nodiscard]] bool stop();
    [[nodiscard]] StopReason stop_reason() const { return reason_; }

    /// Counts a tile; `mark` is called meanwhile, so that locked() sees both or neither.
    void finish_tile(const Tile& tile, std::uint64_t work, const std::function<void()>& mark);
    /// The stage's work so far, and the rays of a preparation that has not been counted yet.
    void advance(std::uint64_t done, const RayCounts& under_way);
    /// Runs what goes before a pass; its time counts as a stage of its own. `counts`: whether what it does is
    /// new.
    void prepare(Preparation& p, bool counts, const std::function<void()>& work);

    /// Counts rays of what is done once.
    void add(const RayCounts& rays);

    /// What earlier runs have done.
    void resume(const WorkDone& earlier);
    /// What has been done, earlier runs included.
    [[nodiscard]] WorkDone work();
    /// Calls `use` with what has been done, while no tile finishes.
    void locked(const std::function<void(const WorkDone&)>& use);

    void warn(const std::string& text);
    [[nodiscard]] RenderStats stats(int threads);

  private:
    [[nodiscard]] double seconds() const;
    [[nodiscard]] StopReason reason_to_stop();
    void tell_progress();

    RenderObserver* observer_;  // may be null
    double time_limit_;
    std::uint64_t memory_limit_;
    std::mutex mutex_;
    std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
    double cpu_begin_;
    double next_memory_check_ = 0;  // seconds
    Progress stage_;
    double stage_begin_ = 0;
    std::uint64_t done_before_ = 0;  // units of the stage
    std::vector<std::pair<std::string, double>> stages_;
    double preparation_seconds_ = 0;
    WorkDone work_;
    double earlier_seconds_ = 0;
    std::atomic<StopReason> reason_ = StopReason::none;
};

}  // namespace relumine
