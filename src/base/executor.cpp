// SPDX-License-Identifier: Apache-2.0
// The executors: oneTBB, and threads of the standard library.
#include "base/executor.hpp"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

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

using Work = std::function<void(std::size_t)>;

void run_on_tbb(int threads, std::size_t count, const Work& work) {
    const tbb::global_control enough(tbb::global_control::max_allowed_parallelism,
                                     static_cast<std::size_t>(threads));
    tbb::task_arena arena(threads);
    arena.execute([&] { tbb::parallel_for(std::size_t{0}, count, work, tbb::simple_partitioner{}); });
}

/// The caller works too; where the system gives out no more threads, fewer do.
void run_on_threads(int threads, std::size_t count, const Work& work) {
    std::atomic<std::size_t> next = 0;
    const auto take_pieces = [&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> helpers;
    try {
        for (std::size_t i = 1; i < std::min(static_cast<std::size_t>(threads), count); ++i)
            helpers.emplace_back(take_pieces);
    } catch (const std::system_error&) {
    }
    take_pieces();
}

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

Executor default_executor() {
#if defined(RELUMINE_EXECUTOR_THREADS)
    return Executor::threads;
#else
    return Executor::tbb;
#endif
}

void parallel_for(int threads, std::size_t count, const Work& work) {
    parallel_for(default_executor(), threads, count, work);
}

void parallel_for(Executor executor, int threads, std::size_t count, const Work& work) {
    FirstError error;
    const auto guarded = [&](std::size_t index) {
        const FlushDenormals flush;
        try {
            work(index);
        } catch (...) {
            error.keep(index, std::current_exception());
        }
    };
    if (executor == Executor::tbb)
        run_on_tbb(threads, count, guarded);
    else
        run_on_threads(threads, count, guarded);
    error.rethrow();
}

}  // namespace relumine
