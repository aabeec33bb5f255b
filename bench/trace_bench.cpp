// SPDX-License-Identifier: Apache-2.0
// What packets are worth: coherent and scattered rays, one by one and sixteen at a time, over a bumpy sphere
// of 300,000 triangles.
#include <benchmark/benchmark.h>

#include "base/executor.hpp"
#include "base/sample_stream.hpp"
#include "trace/tracer.hpp"

namespace relumine {
namespace {

constexpr int rows = 400, columns = 400;
constexpr std::size_t ray_count = 1 << 14;

SceneData bumpy_sphere() {
    SceneData scene;
    scene.materials.resize(1);
    Mesh mesh;
    mesh.positions.reserve((rows + 1) * (columns + 1) + 2);
    for (int i = 0; i <= rows; ++i)
        for (int j = 0; j <= columns; ++j) {
            const float theta = pi * static_cast<float>(i) / rows,
                        phi = 2 * pi * static_cast<float>(j) / columns;
            const float r = 1 + 0.05f * std::sin(20 * theta) * std::sin(20 * phi);
            mesh.positions.push_back({r * std::sin(theta) * std::cos(phi), r * std::cos(theta),
                                      r * std::sin(theta) * std::sin(phi)});
        }
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const std::uint32_t a = i * (columns + 1) + j, b = a + columns + 1;
            mesh.triangles.push_back({{a, b, a + 1}});
            mesh.triangles.push_back({{a + 1, b, b + 1}});
        }
    scene.meshes.push_back(std::move(mesh));
    Instance instance;
    instance.identity = true;
    scene.instances.push_back(instance);
    return scene;
}

const Tracer& tracer() {
    static const SceneData scene = bumpy_sphere();
    static const Tracer tracer(scene, [](const Hit&) { return 1.0f; });
    return tracer;
}

/// Camera rays of neighbouring pixels, or rays from random points inside the sphere to random directions.
std::vector<Ray> make_rays(bool coherent) {
    std::vector<Ray> rays;
    for (std::uint32_t i = 0; i < ray_count; ++i) {
        const SampleStream s{1, i, 1, PointSet::independent};
        const auto [u, v] = s.next2(Dim::direction);
        const float z = 1 - 2 * u, r = std::sqrt(1 - z * z);
        const std::uint32_t block = i / 16, x = 4 * (block % 32) + i % 4, y = 4 * (block / 32) + i / 4 % 4;
        const Vec3 pixel{static_cast<float>(x) / 64 - 1, static_cast<float>(y) / 64 - 1, -2};
        if (coherent) rays.push_back({{0, 0, 3}, {normalize(pixel)}});
        if (!coherent)
            rays.push_back({Vec3{u, v, s.next1(Dim::lobe)} * 0.5f,
                            {{r * std::cos(2 * pi * v), z, r * std::sin(2 * pi * v)}}});
    }
    return rays;
}

void single_rays(benchmark::State& state) {
    const FlushDenormals flush;
    const std::vector<Ray> rays = make_rays(state.range(0) != 0);
    for ([[maybe_unused]] auto _ : state)
        for (const Ray& ray : rays) benchmark::DoNotOptimize(tracer().closest_hit(ray));
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ray_count));
}
BENCHMARK(single_rays)->ArgName("coherent")->Arg(1)->Arg(0);

void packets(benchmark::State& state) {
    const FlushDenormals flush;
    const bool coherent = state.range(0) != 0;
    const std::vector<Ray> rays = make_rays(coherent);
    std::array<Hit, packet_size> hits;
    for ([[maybe_unused]] auto _ : state)
        for (std::size_t i = 0; i < ray_count; i += packet_size) {
            tracer().closest_hits(std::span(rays).subspan(i).first<packet_size>(), hits,
                                  coherent ? Coherence::coherent : Coherence::incoherent);
            benchmark::DoNotOptimize(hits);
        }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(ray_count));
}
BENCHMARK(packets)->ArgName("coherent")->Arg(1)->Arg(0);

void random_numbers(benchmark::State& state) {
    const auto set = static_cast<PointSet>(state.range(0));
    std::uint32_t i = 0;
    for ([[maybe_unused]] auto _ : state)
        benchmark::DoNotOptimize(SampleStream{5, i++ & 63, 64, set}.next2(Dim::direction, 1));
}
BENCHMARK(random_numbers)->ArgName("set")->Arg(0)->Arg(1)->Arg(2);

}  // namespace
}  // namespace relumine
