// SPDX-License-Identifier: Apache-2.0
// The three point sets.
#include "base/sample_stream.hpp"

#include "base/sobol.hpp"

namespace relumine {
namespace {

constexpr std::uint32_t low(std::uint64_t x) { return static_cast<std::uint32_t>(x); }
constexpr std::uint32_t high(std::uint64_t x) { return static_cast<std::uint32_t>(x >> 32); }

/// The index in a random order of its own for every pair of dimensions, so that pairs do not correlate.
/// Returned bit-reversed twice, that is in natural order: any aligned power-of-two run of indices stays one.
std::uint32_t shuffled(std::uint32_t index, std::uint32_t seed) { return owen_scramble(index, seed); }

Point2 sobol2(std::uint32_t index, std::uint64_t key) {
    const std::uint32_t i = shuffled(index, low(key));
    const std::uint32_t x = reverse_bits(laine_karras(i, high(key)));
    const std::uint32_t y =
        reverse_bits(laine_karras(sobol_second_reversed(i), high(key * 0xd1342543de82ef95u)));
    return {unit_float(x), unit_float(y)};
}

float sobol1(std::uint32_t index, std::uint64_t key) {
    return unit_float(reverse_bits(laine_karras(shuffled(index, low(key)), high(key))));
}

/// A random permutation of [0, length) that `pattern` names [Kensler13, listing 1].
std::uint32_t permute(std::uint32_t i, std::uint32_t length, std::uint32_t pattern) {
    if (length <= 1) return 0;
    const std::uint32_t w = [&] {
        std::uint32_t mask = length - 1;
        for (const int shift : {1, 2, 4, 8, 16}) mask |= mask >> shift;
        return mask;
    }();
    do {
        i ^= pattern;
        i *= 0xe170893du;
        i ^= pattern >> 16;
        i ^= (i & w) >> 4;
        i ^= pattern >> 8;
        i *= 0x0929eb3fu;
        i ^= pattern >> 23;
        i ^= (i & w) >> 1;
        i *= 1 | pattern >> 27;
        i *= 0x6935fa69u;
        i ^= (i & w) >> 11;
        i *= 0x74dcb303u;
        i ^= (i & w) >> 2;
        i *= 0x9e501cc3u;
        i ^= (i & w) >> 2;
        i *= 0xc860a3dfu;
        i &= w;
        i ^= i >> 5;
    } while (i >= length);
    return (i + pattern) % length;
}

/// Strata (ix, iy) of a grid of columns × rows cells, jittered so that each axis alone is stratified
/// count-fold too.
Point2 correlated_multi_jitter(std::uint32_t index, std::uint32_t count, std::uint64_t key) {
    const auto columns = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(count)));
    const std::uint32_t rows = (count + columns - 1) / columns;
    const std::uint32_t s = permute(index, count, low(key));
    const std::uint64_t jitter = hash(key, s);
    const std::uint32_t column = s % columns, row = s / columns;
    const auto nx = static_cast<float>(columns), ny = static_cast<float>(rows);
    const auto fine_x = static_cast<float>(permute(row, rows, high(key)));
    if (columns * rows != count) {  // the last row is not whole: strata of y alone, permuted columns
        const auto permuted_column = static_cast<float>(permute(column, columns, low(mix(key))));
        const float irregular_x = (permuted_column + (fine_x + unit_float(low(jitter))) / ny) / nx;
        const float irregular_y =
            (static_cast<float>(s) + unit_float(high(jitter))) / static_cast<float>(count);
        return {std::min(irregular_x, 0x1.fffffep-1f), std::min(irregular_y, 0x1.fffffep-1f)};
    }
    const auto fine_y = static_cast<float>(permute(column, columns, low(mix(key))));
    const float x = (static_cast<float>(column) + (fine_x + unit_float(low(jitter))) / ny) / nx;
    const float y = (static_cast<float>(row) + (fine_y + unit_float(high(jitter))) / nx) / ny;
    return {std::min(x, 0x1.fffffep-1f), std::min(y, 0x1.fffffep-1f)};
}

float jitter1(std::uint32_t index, std::uint32_t count, std::uint64_t key) {
    const std::uint32_t s = permute(index, count, low(key));
    const float x = (static_cast<float>(s) + unit_float(low(hash(key, s)))) / static_cast<float>(count);
    return std::min(x, 0x1.fffffep-1f);
}

}  // namespace

float SampleStream::next1(Dim dim, std::uint32_t vertex) const {
    const std::uint64_t k = dimension_key(dim, vertex);
    if (set == PointSet::sobol) return sobol1(index, k);
    if (set == PointSet::stratified && index < count) return jitter1(index, count, k);
    return unit_float(low(hash(k, index)));
}

Point2 SampleStream::next2(Dim dim, std::uint32_t vertex) const {
    const std::uint64_t k = dimension_key(dim, vertex);
    if (set == PointSet::sobol) return sobol2(index, k);
    if (set == PointSet::stratified && index < count) return correlated_multi_jitter(index, count, k);
    const std::uint64_t random = hash(k, index);
    return {unit_float(low(random)), unit_float(high(random))};
}

}  // namespace relumine
