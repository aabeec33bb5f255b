// SPDX-License-Identifier: Apache-2.0
// Values of a packet side by side: lane i belongs to the packet's path i.
#pragma once

#include <array>
#include <cstdint>

#include "base/packet.hpp"
#include "base/vec.hpp"

namespace relumine {

/// Aligned for any vector register.
template <typename T>
struct alignas(64) Lanes : std::array<T, packet_size> {};

/// Which lanes count: −1 where they do, else 0, as vector compares and Embree have it.
using LaneMask = Lanes<std::int32_t>;

struct Vec3Lanes {
    Lanes<float> x, y, z;

    [[nodiscard]] Vec3 operator[](std::size_t lane) const { return {x[lane], y[lane], z[lane]}; }
    void set(std::size_t lane, Vec3 v) {
        x[lane] = v.x;
        y[lane] = v.y;
        z[lane] = v.z;
    }
    void take(std::size_t lane, const Vec3Lanes& other, std::size_t other_lane) {
        set(lane, other[other_lane]);
    }
};

struct SpectrumLanes {
    Lanes<float> r, g, b;

    [[nodiscard]] Spectrum operator[](std::size_t lane) const { return {r[lane], g[lane], b[lane]}; }
    void set(std::size_t lane, Spectrum s) {
        r[lane] = s.r;
        g[lane] = s.g;
        b[lane] = s.b;
    }
    void take(std::size_t lane, const SpectrumLanes& other, std::size_t other_lane) {
        set(lane, other[other_lane]);
    }
};

}  // namespace relumine
