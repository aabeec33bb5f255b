// SPDX-License-Identifier: Apache-2.0
// What every sample and every tile pays: the hash behind each random number, and handing out work to threads.
#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>

#include "base/executor.hpp"
#include "base/frame.hpp"
#include "base/hash.hpp"
#include "base/sample_packet_kernel.hpp"

namespace {

using relumine::Vec3;

// One random number: a hash of seed, pixel, sample and dimension. Each takes the one before as its seed:
// latency.
void random_number(benchmark::State& state) {
    std::uint64_t seed = 1;
    for (auto _ : state) {
        seed = relumine::hash(seed, std::uint64_t{1234}, 56, 7);
        benchmark::DoNotOptimize(seed);
    }
}
BENCHMARK(random_number);

// A point from a Sobol sequence for each of sixteen pixels: stream by stream, or all at once in SIMD lanes.
void sobol_points(benchmark::State& state) {
    using namespace relumine;
    std::array<SampleStream, packet_size> streams;
    for (std::uint32_t i = 0; i < packet_size; ++i) streams[i] = {hash(1, i), 5, 64, PointSet::sobol};
    const SamplePacket packet(streams);
    SamplePacket::Lanes<float> x{}, y{};
    std::uint32_t vertex = 0;
    for (auto _ : state) {
        ++vertex;
        if (state.range(0) == 1) packet.next2(Dim::direction, vertex, x, y);
        for (std::size_t i = 0; state.range(0) == 0 && i < packet_size; ++i) {
            const Point2 u = streams[i].next2(Dim::direction, vertex);
            x[i] = u.x;
            y[i] = u.y;
        }
        benchmark::DoNotOptimize(x);
        benchmark::DoNotOptimize(y);
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(packet_size));
}
BENCHMARK(sobol_points)->ArgName("packet")->Arg(0)->Arg(1);

void frame_around_normal(benchmark::State& state) {
    Vec3 normal{0, 0, 1};
    for (auto _ : state) {
        benchmark::DoNotOptimize(normal);
        benchmark::DoNotOptimize(relumine::frame_around(normal));
    }
}
BENCHMARK(frame_around_normal);

// The cost of a tile that does nothing: 1024 of them, about as many as a picture of 1024 × 1024 pixels has.
void empty_tiles(benchmark::State& state) {
    constexpr std::size_t tiles = 1024;
    const int threads = static_cast<int>(state.range(0));
    for (auto _ : state)
        relumine::parallel_for(threads, tiles, [](std::size_t tile) { benchmark::DoNotOptimize(tile); });
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(tiles));
}
BENCHMARK(empty_tiles)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime();

}  // namespace
