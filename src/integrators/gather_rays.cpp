// SPDX-License-Identifier: Apache-2.0
// Streams of gather rays.
#include "integrators/gather_rays.hpp"

namespace relumine {

SampleStream gather_stream(const SampleStream& sample, std::uint64_t purpose, std::uint32_t i,
                           std::uint32_t rays) {
    if (sample.set == PointSet::sobol)
        return {hash(sample.key, purpose), sample.index * rays + i, sample.count * rays, sample.set};
    return {hash(sample.key, purpose, sample.index), i, rays, sample.set};
}

Point2 direction_numbers(const SampleStream& stream, std::uint32_t depth) {
    const auto n = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(stream.count))));
    if (stream.set != PointSet::stratified || n * n != stream.count || n % 4 != 0)
        return stream.next2(Dim::direction, depth);
    const std::uint32_t i = stream.index, block = i / 16;
    const std::uint32_t column = 4 * (block % (n / 4)) + i % 4, row = 4 * (block / (n / 4)) + i / 4 % 4;
    const std::uint64_t jitter = hash(stream.key, i, 2 * depth + 1);
    const auto in_stratum = [&](std::uint32_t stratum, std::uint64_t bits) {
        const float x = (static_cast<float>(stratum) + unit_float(static_cast<std::uint32_t>(bits)))
                        / static_cast<float>(n);
        return std::min(x, 0x1.fffffep-1f);
    };
    return {in_stratum(column, jitter), in_stratum(row, jitter >> 32)};
}

}  // namespace relumine
