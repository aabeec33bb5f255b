// SPDX-License-Identifier: Apache-2.0
// Keeps checkpoints of a render: when, under which name, and for whom.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <mutex>
#include <optional>

#include "film/checkpoint.hpp"
#include "relumine/render.hpp"
#include "scene/scene_data.hpp"

namespace relumine {

/// Everything that the bits of the picture depend on.
[[nodiscard]] Identity picture_identity(const SceneData& scene, const RenderSettings& settings);

/// The checkpoints of one render; none where no file is named. Any number of threads may use it.
class Keeper {
  public:
    /// `warn` hears of the first checkpoint that cannot be written: that does not end a render.
    Keeper(const RenderControl& control, Identity identity, std::function<void(const std::string&)> warn);

    [[nodiscard]] bool active() const { return !control_.checkpoint.empty(); }

    /// The checkpoint to go on from, if one is wanted and there. Throws FileError for a damaged or foreign
    /// one.
    [[nodiscard]] std::optional<Checkpoint> find() const;

    /// Whether it is time for the next one; true for one caller alone, who then writes.
    [[nodiscard]] bool due();
    void write(Checkpoint checkpoint);

    [[nodiscard]] std::uint64_t written() const { return written_; }
    [[nodiscard]] std::uint64_t failed() const { return failed_; }

  private:
    using Clock = std::chrono::steady_clock;

    const RenderControl& control_;
    Identity identity_;
    std::function<void(const std::string&)> warn_;
    std::mutex mutex_;  // of what follows
    Clock::time_point last_ = Clock::now();
    bool busy_ = false;
    std::atomic<std::uint64_t> written_ = 0, failed_ = 0;
};

}  // namespace relumine
