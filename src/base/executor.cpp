// SPDX-License-Identifier: Apache-2.0
// The executor on oneTBB.
#include "base/executor.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <exception>
#include <mutex>
#include <thread>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace relumine {
namespace {

/// Keeps the exception of the lowest index.
class FirstError {
  public:
    void keep(std::size_t index, std::exception_ptr error) {
        const std::lock_guard lock(mutex_);
        if (error_ && index_ <= index) return;
        index_ = index;
        error_ = std::move(error);
    }
    void rethrow() const {
        if (error_) std::rethrow_exception(error_);
    }

  private:
    std::mutex mutex_;
    std::size_t index_ = 0;
    std::exception_ptr error_;
};

}  // namespace

FlushDenormals::FlushDenormals() : saved_(0) {
#if defined(__SSE2__)
    constexpr unsigned flush_to_zero = 0x8000, denormals_are_zero = 0x0040;
    saved_ = _mm_getcsr();
    _mm_setcsr(saved_ | flush_to_zero | denormals_are_zero);
#endif
}

FlushDenormals::~FlushDenormals() {
#if defined(__SSE2__)
    _mm_setcsr(saved_);
#endif
}

int resolve_threads(int requested) {
    return requested > 0 ? requested : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(int threads, std::size_t count, const std::function<void(std::size_t)>& work) {
    FirstError error;
    const auto guarded = [&](std::size_t index) {
        const FlushDenormals flush;
        try {
            work(index);
        } catch (...) {
            error.keep(index, std::current_exception());
        }
    };
    const tbb::global_control enough(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, guarded, tbb::simple_partitioner{}); });
    error.rethrow();
}

}  // namespace relumine
