// SPDX-License-Identifier: Apache-2.0
// Runs independent pieces of work on a given number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

namespace relumine {

/// Who gives out the pieces of work; never changes what comes of them.
enum class Executor : std::uint8_t {
    tbb,     // oneTBB: its threads wait for the next call
    threads  // std::thread, begun and joined by every call: what ThreadSanitizer can follow
};

/// That of this build (CMake's RELUMINE_EXECUTOR).
[[nodiscard]] Executor default_executor();

/// Calls `work(i)` once for each i in [0, count), on up to `threads` threads (≥ 1), in no particular order.
/// Denormals are flushed to zero inside. If calls throw, the exception of the lowest index is rethrown.
void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& work);

/// The same on a given executor.
void parallel_for(Executor executor, int threads, std::size_t count,
                  const std::function<void(std::size_t)>& work);

/// The number of threads that `requested` means: itself, or all of the machine's for 0.
int resolve_threads(int requested);

/// While it lives, this thread flushes denormal floats to zero on input and output, as Embree wants.
class FlushDenormals {
  public:
    FlushDenormals();
    ~FlushDenormals();
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

  private:
    unsigned saved_;
};

}  // namespace relumine
