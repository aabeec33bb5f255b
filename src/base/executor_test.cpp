// SPDX-License-Identifier: Apache-2.0
// Both executors: every piece once, no more threads than asked for, errors by index.
#include "base/executor.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace relumine {
namespace {

/// oneTBB's is left out where ThreadSanitizer could not follow it.
std::vector<Executor> executors() {
    if (default_executor() == Executor::threads) return {Executor::threads};
    return {Executor::tbb, Executor::threads};
}

class Executors : public testing::TestWithParam<Executor> {};

INSTANTIATE_TEST_SUITE_P(Each, Executors, testing::ValuesIn(executors()), [](const auto& param) {
    return std::string(param.param == Executor::tbb ? "Tbb" : "Threads");
});

TEST_P(Executors, CallEveryPieceOnce) {
    for (const int threads : {1, 2, 7})
        for (const std::size_t count : {std::size_t{0}, std::size_t{1}, std::size_t{5}, std::size_t{1000}}) {
            std::vector<std::atomic<int>> calls(count + 1);
            parallel_for(GetParam(), threads, count, [&](std::size_t i) { ++calls.at(i); });
            for (std::size_t i = 0; i <= count; ++i) EXPECT_EQ(calls[i], i < count ? 1 : 0) << i;
        }
}

TEST_P(Executors, UseAtMostTheThreadsAskedFor) {
    for (const std::size_t threads : {std::size_t{1}, std::size_t{3}}) {
        std::mutex mutex;
        std::set<std::thread::id> seen;
        parallel_for(GetParam(), static_cast<int>(threads), 200, [&](std::size_t) {
            std::this_thread::yield();
            const std::lock_guard lock(mutex);
            seen.insert(std::this_thread::get_id());
        });
        EXPECT_LE(seen.size(), threads);
    }
}

TEST_P(Executors, WhatPiecesWroteIsSeenAfterwards) {
    std::vector<std::size_t> squares(500);
    parallel_for(GetParam(), 4, squares.size(), [&](std::size_t i) { squares[i] = i * i; });
    for (std::size_t i = 0; i < squares.size(); ++i) EXPECT_EQ(squares[i], i * i);
}

TEST_P(Executors, RethrowTheErrorOfTheLowestPieceAfterAllAreDone) {
    for (const int threads : {1, 4}) {
        std::atomic<int> calls = 0;
        try {
            parallel_for(GetParam(), threads, 100, [&](std::size_t i) {
                ++calls;
                if (i % 10 == 7) throw std::runtime_error(std::to_string(i));
            });
            ADD_FAILURE() << "nothing was thrown";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "7");
        }
        EXPECT_EQ(calls, 100);
    }
}

TEST_P(Executors, MayBeCalledInsideEachOtherAndByManyAtOnce) {
    std::atomic<int> calls = 0;
    const auto nested = [&] {
        parallel_for(GetParam(), 3, 10,
                     [&](std::size_t) { parallel_for(GetParam(), 2, 10, [&](std::size_t) { ++calls; }); });
    };
    {
        std::jthread other(nested);
        nested();
    }
    EXPECT_EQ(calls, 200);
}

TEST_P(Executors, FlushDenormalsInsideAlone) {
#if defined(__SSE2__)
    volatile float smallest = std::numeric_limits<float>::min();
    std::atomic<int> flushed = 0;
    parallel_for(GetParam(), 2, 10, [&](std::size_t) { flushed += smallest / 2 == 0 ? 1 : 0; });
    EXPECT_EQ(flushed, 10);
    EXPECT_NE(smallest / 2, 0);
#else
    GTEST_SKIP() << "no such switch here";
#endif
}

}  // namespace
}  // namespace relumine
