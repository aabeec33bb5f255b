// SPDX-License-Identifier: Apache-2.0
// pbrt's spheres, disks, cylinders and bilinear patches, cut into triangles with exact normals at the
// vertices.
#include <fmt/format.h>

#include <cmath>
#include <functional>

#include "scene/pbrt_shapes.hpp"

namespace relumine {
namespace {

constexpr double pi_d = 3.14159265358979323846;

/// A point of a surface and its (outward) normal.
struct SurfaceSample {
    std::array<double, 3> position, normal;
};

Vec3 to_vec3(const std::array<double, 3>& a) {
    return {static_cast<float>(a[0]), static_cast<float>(a[1]), static_cast<float>(a[2])};
}

/// Rows where all of u meet in one point, such as a pole: their triangles are single.
struct Poles {
    bool first = false, last = false;
};

/// A grid over (u, v) in [0, 1]². Triangles keep v upwards and u to the right.
Mesh make_grid(int columns, int rows, Poles poles,
               const std::function<SurfaceSample(double u, double v)>& at) {
    Mesh mesh;
    for (int j = 0; j <= rows; ++j) {
        const bool pole = (j == 0 && poles.first) || (j == rows && poles.last);
        for (int i = 0; i <= columns; ++i) {
            const double u = std::min(1.0, (i + (pole ? 0.5 : 0.0)) / columns), v = double(j) / rows;
            const SurfaceSample sample = at(u, v);
            mesh.positions.push_back(to_vec3(sample.position));
            mesh.normals.push_back(to_vec3(sample.normal));
            mesh.uvs[0].push_back({static_cast<float>(u), static_cast<float>(1 - v)});
        }
    }
    for (int j = 0; j < rows; ++j) {
        for (int i = 0; i < columns; ++i) {
            const auto a = static_cast<std::uint32_t>(j * (columns + 1) + i);
            const std::uint32_t b = a + 1, c = a + static_cast<std::uint32_t>(columns) + 1, d = c + 1;
            if (j != 0 || !poles.first) mesh.triangles.push_back({{a, b, d}});
            const bool last = j == rows - 1 && poles.last;
            if (j == 0 && poles.first)
                mesh.triangles.push_back({{a, d, c}});
            else if (!last)
                mesh.triangles.push_back({{a, d, c}});
            else
                mesh.triangles.back() = {{a, b, c}};
        }
    }
    return mesh;
}

double checked_radius(const PbrtParameters& p) {
    const double radius = p.number("radius", 1);
    if (!(radius > 0)) p.refuse("radius", "a radius above 0", fmt::format("{:g}", radius));
    return radius;
}

double checked_phi(const PbrtParameters& p) {
    const double degrees = p.number("phimax", 360);
    if (!(degrees > 0)) p.refuse("phimax", "an angle above 0", fmt::format("{:g}", degrees));
    return std::min(degrees, 360.0) * pi_d / 180;
}

int pieces(double angle, int circle) {
    return std::max(3, static_cast<int>(std::ceil(circle * angle / (2 * pi_d) - 1e-9)));
}

}  // namespace

Mesh pbrt_sphere(const PbrtParameters& p, const PbrtDetail& detail) {
    const double radius = checked_radius(p), phi_max = checked_phi(p);
    const double z0 = p.number("zmin", -radius), z1 = p.number("zmax", radius);
    const double z_low = std::clamp(std::min(z0, z1), -radius, radius);
    const double z_high = std::clamp(std::max(z0, z1), -radius, radius);
    if (!(z_low < z_high)) p.refuse("zmin", "zmin below zmax", fmt::format("{:g} and {:g}", z0, z1));
    const double theta_low = std::acos(z_low / radius), theta_high = std::acos(z_high / radius);
    const auto at = [&](double u, double v) -> SurfaceSample {
        const double phi = u * phi_max, theta = std::lerp(theta_low, theta_high, v);
        const double s = std::sin(theta);
        const std::array<double, 3> n{s * std::cos(phi), s * std::sin(phi), std::cos(theta)};
        return {{radius * n[0], radius * n[1], radius * n[2]}, n};
    };
    return make_grid(pieces(phi_max, detail.circle), pieces(theta_low - theta_high, detail.circle),
                     {z_low <= -radius, z_high >= radius}, at);
}

Mesh pbrt_disk(const PbrtParameters& p, const PbrtDetail& detail) {
    const double radius = checked_radius(p), phi_max = checked_phi(p);
    const double height = p.number("height", 0), inner = p.number("innerradius", 0);
    if (!(inner >= 0 && inner < radius))
        p.refuse("innerradius", "an inner radius of 0 to below the outer one", fmt::format("{:g}", inner));
    const auto at = [&](double u, double v) -> SurfaceSample {
        const double phi = u * phi_max, r = std::lerp(radius, inner, v);
        return {{r * std::cos(phi), r * std::sin(phi), height}, {0, 0, 1}};
    };
    return make_grid(pieces(phi_max, detail.circle), 1, {false, inner == 0}, at);
}

Mesh pbrt_cylinder(const PbrtParameters& p, const PbrtDetail& detail) {
    const double radius = checked_radius(p), phi_max = checked_phi(p);
    const double z0 = p.number("zmin", -1), z1 = p.number("zmax", 1);
    const double z_low = std::min(z0, z1), z_high = std::max(z0, z1);
    if (!(z_low < z_high)) p.refuse("zmin", "zmin below zmax", fmt::format("{:g} and {:g}", z0, z1));
    const auto at = [&](double u, double v) -> SurfaceSample {
        const double phi = u * phi_max, x = std::cos(phi), y = std::sin(phi);
        return {{radius * x, radius * y, std::lerp(z_low, z_high, v)}, {x, y, 0}};
    };
    return make_grid(pieces(phi_max, detail.circle), 1, {}, at);
}

namespace {

/// The corners of a patch and what they carry: 00, 10, 01, 11.
template <typename T>
struct Corners {
    std::array<T, 4> c;

    [[nodiscard]] T at(float u, float v) const {
        return (c[0] * (1 - u) + c[1] * u) * (1 - v) + (c[2] * (1 - u) + c[3] * u) * v;
    }
};

bool is_parallelogram(const Corners<Vec3>& p) {
    const Vec3 gap = p.c[0] + p.c[3] - p.c[1] - p.c[2];
    const float size = std::max(length(p.c[1] - p.c[0]), length(p.c[2] - p.c[0]));
    return length(gap) <= 1e-5f * size;
}
bool is_parallelogram(const Corners<Vec2>& p) {
    const Vec2 gap = p.c[0] + p.c[3] - p.c[1] - p.c[2];
    return std::abs(gap.x) + std::abs(gap.y) <= 1e-5f;
}

Vec3 patch_normal(const Corners<Vec3>& p, float u, float v) {
    const Vec3 du = lerp(p.c[1] - p.c[0], p.c[3] - p.c[2], v);
    const Vec3 dv = lerp(p.c[2] - p.c[0], p.c[3] - p.c[1], u);
    const Vec3 n = cross(du, dv);
    return max_abs(n) > 0 ? normalize(n / max_abs(n)) : Vec3{};
}

}  // namespace

Mesh pbrt_bilinear_mesh(const PbrtParameters& p, const PbrtDetail& detail) {
    const std::vector<Vec3> positions = p.vectors("point3", "P"), normals = p.vectors("normal", "N");
    std::vector<Vec2> uvs = p.points2("uv");
    if (positions.empty()) p.refuse("P", "\"point3 P\"", "none");
    if (!normals.empty() && normals.size() != positions.size())
        p.refuse("N", fmt::format("{} values", positions.size()), fmt::format("{}", normals.size()));
    if (!uvs.empty() && uvs.size() != positions.size())
        p.refuse("uv", fmt::format("{} values", positions.size()), fmt::format("{}", uvs.size()));
    p.ignore({"faceIndices", "emissionfilename"});
    const std::vector<std::uint32_t> corners = pbrt_indices(p, 4, positions.size());
    Mesh mesh;
    for (std::size_t i = 0; i + 3 < corners.size(); i += 4) {
        const auto take = [&](const auto& values) {
            return Corners<std::decay_t<decltype(values[0])>>{
                {values[corners[i]], values[corners[i + 1]], values[corners[i + 2]], values[corners[i + 3]]}};
        };
        const Corners<Vec3> position = take(positions);
        const Corners<Vec2> uv =
            uvs.empty() ? Corners<Vec2>{{Vec2{0, 0}, {1, 0}, {0, 1}, {1, 1}}} : take(uvs);
        const int n = is_parallelogram(position) && is_parallelogram(uv) ? 1 : detail.patch;
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        const auto row = static_cast<std::uint32_t>(n + 1);
        for (int k = 0; k <= n; ++k) {
            for (int j = 0; j <= n; ++j) {
                const float u = static_cast<float>(j) / static_cast<float>(n);
                const float v = static_cast<float>(k) / static_cast<float>(n);
                const Vec2 st = uv.at(u, v);
                mesh.positions.push_back(position.at(u, v));
                mesh.normals.push_back(normals.empty() ? patch_normal(position, u, v)
                                                       : take(normals).at(u, v));
                mesh.uvs[0].push_back({st.x, 1 - st.y});
            }
        }
        for (std::uint32_t k = 0; k + 1 < row; ++k) {
            for (std::uint32_t j = 0; j + 1 < row; ++j) {
                const std::uint32_t a = first + k * row + j, b = a + 1, c = a + row, d = c + 1;
                mesh.triangles.push_back({{a, b, d}});
                mesh.triangles.push_back({{a, d, c}});
            }
        }
    }
    return mesh;
}

}  // namespace relumine
