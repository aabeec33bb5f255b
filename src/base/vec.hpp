// SPDX-License-Identifier: Apache-2.0
// Small vectors: points, directions and linear RGB spectra.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace relumine {

inline constexpr float pi = 3.14159265358979323846f;
inline constexpr float inv_pi = 0.31830988618379067154f;
inline constexpr float infinity = std::numeric_limits<float>::infinity();

struct Vec2 {
    float x = 0, y = 0;

    friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
    friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
    friend constexpr Vec2 operator*(Vec2 a, float s) { return {a.x * s, a.y * s}; }
    bool operator==(const Vec2&) const = default;
};
using Point2 = Vec2;  // usually a pair of random numbers in [0, 1)²

struct Vec3 {
    float x = 0, y = 0, z = 0;

    constexpr float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
    friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
    friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
    friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
    friend constexpr Vec3 operator*(Vec3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
    friend constexpr Vec3 operator*(float s, Vec3 a) { return a * s; }
    friend constexpr Vec3 operator/(Vec3 a, float s) { return a * (1 / s); }
    Vec3& operator+=(Vec3 b) { return *this = *this + b; }
    bool operator==(const Vec3&) const = default;
};

struct Vec4 {
    float x = 0, y = 0, z = 0, w = 0;

    bool operator==(const Vec4&) const = default;
};

constexpr float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
constexpr float length_squared(Vec3 a) { return dot(a, a); }
inline float length(Vec3 a) { return std::sqrt(length_squared(a)); }
inline Vec3 normalize(Vec3 a) { return a / length(a); }
constexpr float lerp(float a, float b, float t) { return (1 - t) * a + t * b; }
constexpr Vec3 lerp(Vec3 a, Vec3 b, float t) { return a * (1 - t) + b * t; }
inline float max_abs(Vec3 a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }
constexpr float sqr(float x) { return x * x; }

/// `a` where it points to the side of `reference`, else −`a`.
constexpr Vec3 face_forward(Vec3 a, Vec3 reference) { return dot(a, reference) < 0 ? -a : a; }

/// Linear Rec. 709 RGB: radiance, throughput, albedo… as the name beside it says.
struct Spectrum {
    float r = 0, g = 0, b = 0;

    constexpr Spectrum() = default;
    constexpr explicit Spectrum(float grey) : r(grey), g(grey), b(grey) {}
    constexpr Spectrum(float red, float green, float blue) : r(red), g(green), b(blue) {}

    friend constexpr Spectrum operator+(Spectrum a, Spectrum c) { return {a.r + c.r, a.g + c.g, a.b + c.b}; }
    friend constexpr Spectrum operator-(Spectrum a, Spectrum c) { return {a.r - c.r, a.g - c.g, a.b - c.b}; }
    friend constexpr Spectrum operator*(Spectrum a, Spectrum c) { return {a.r * c.r, a.g * c.g, a.b * c.b}; }
    friend constexpr Spectrum operator*(Spectrum a, float s) { return {a.r * s, a.g * s, a.b * s}; }
    friend constexpr Spectrum operator*(float s, Spectrum a) { return a * s; }
    friend constexpr Spectrum operator/(Spectrum a, float s) { return a * (1 / s); }
    Spectrum& operator+=(Spectrum c) { return *this = *this + c; }
    Spectrum& operator*=(Spectrum c) { return *this = *this * c; }
    Spectrum& operator*=(float s) { return *this = *this * s; }
    bool operator==(const Spectrum&) const = default;
};

constexpr float max_component(Spectrum s) { return std::max({s.r, s.g, s.b}); }
constexpr float luminance(Spectrum s) { return 0.2126f * s.r + 0.7152f * s.g + 0.0722f * s.b; }
constexpr bool is_black(Spectrum s) { return s.r == 0 && s.g == 0 && s.b == 0; }
inline bool is_finite(Spectrum s) { return std::isfinite(s.r) && std::isfinite(s.g) && std::isfinite(s.b); }
constexpr Spectrum lerp(Spectrum a, Spectrum b, float t) { return a * (1 - t) + b * t; }

/// An axis-aligned box; empty until something is added.
struct Bounds3 {
    Vec3 lower{infinity, infinity, infinity}, upper{-infinity, -infinity, -infinity};

    void add(Vec3 p) {
        lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
        upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
    }
    [[nodiscard]] bool empty() const { return lower.x > upper.x; }
    [[nodiscard]] Vec3 center() const { return 0.5f * lower + 0.5f * upper; }
    [[nodiscard]] float radius() const { return empty() ? 0.0f : 0.5f * length(upper - lower); }
};

}  // namespace relumine
