// SPDX-License-Identifier: Apache-2.0
// The steps of reprojection, one kernel each, for a point of a floor that a bumpy body of 160,000 triangles
// stands on.
#include <benchmark/benchmark.h>

#include "base/executor.hpp"
#include "cache/draw_kernel.hpp"
#include "cache/gap_fill.hpp"
#include "cache/reproject.hpp"
#include "cache/shade.hpp"

namespace relumine {
namespace {

void add_mesh(SceneData& scene, Mesh mesh) {
    Instance instance;
    instance.mesh = MeshId{static_cast<std::uint32_t>(scene.meshes.size())};
    instance.identity = true;
    scene.meshes.push_back(std::move(mesh));
    scene.instances.push_back(instance);
}

Mesh bumpy_body() {
    constexpr int rows = 200, columns = 400;
    Mesh mesh;
    for (int i = 0; i <= rows; ++i)
        for (int j = 0; j <= columns; ++j) {
            const float theta = pi * static_cast<float>(i) / rows,
                        phi = 2 * pi * static_cast<float>(j) / columns;
            const float r = 1 + 0.08f * std::sin(15 * theta) * std::sin(15 * phi);
            mesh.positions.push_back({r * std::sin(theta) * std::cos(phi), 0.95f + r * std::cos(theta),
                                      r * std::sin(theta) * std::sin(phi)});
        }
    for (std::uint32_t i = 0; i < rows; ++i)
        for (std::uint32_t j = 0; j < columns; ++j) {
            const std::uint32_t a = i * (columns + 1) + j, b = a + columns + 1;
            mesh.triangles.push_back({{a, b, a + 1}});
            mesh.triangles.push_back({{a + 1, b, b + 1}});
        }
    return mesh;
}

Mesh floor() {
    Mesh mesh;
    mesh.positions = {{-8, 0, -8}, {8, 0, -8}, {8, 0, 8}, {-8, 0, 8}};
    mesh.triangles = {{{0, 2, 1}}, {{0, 3, 2}}};
    return mesh;
}

struct Stage {
    SceneData scene;
    std::unique_ptr<Tracer> tracer;
    std::unique_ptr<LightSampler> lights;
    std::unique_ptr<UniformBsdfs> bsdfs;
    std::unique_ptr<Transport> transport;
    std::unique_ptr<IncidentRadiance> source;
    GatherPoint point{{1.3f, 0, 0.4f}, frame_around({0, 1, 0}), 1e-5f, 0};
    Record record;
    Receiver receiver;
    ReceiverBsdf bsdf;

    Stage() {
        const FlushDenormals flush;
        scene.materials.resize(1);
        add_mesh(scene, floor());
        add_mesh(scene, bumpy_body());
        tracer = std::make_unique<Tracer>(scene, [](const Hit&) { return 1.0f; });
        lights = std::make_unique<LightSampler>(scene, LightSelection{});
        bsdfs = std::make_unique<UniformBsdfs>(scene, Masking::correlated);
        transport =
            std::make_unique<Transport>(Transport{scene, *tracer, *lights, *bsdfs, Masking::correlated});
        source = std::make_unique<IncidentRadiance>(IncidentRadiance{*transport, 1, 0});
        RayCounts rays;
        record = make_record(*source, point, {}, {0.35f, 0.01f, 0.1f}, 1, rays);
        const Vec3 tilted = normalize({0.03f, 1, -0.02f});
        receiver = {point.position + Vec3{0.03f, 0, 0.02f}, receiver_frame(record.frame, tilted)};
        bsdf.diffuse = Spectrum{0.3f};
        bsdf.coat_f0 = bsdf.specular_f0 = Spectrum{0.04f};
        bsdf.coat_f90 = bsdf.specular_f90 = Spectrum{1};
        bsdf.coated = bsdf.specular = true;
        bsdf.ggx.alpha = 0.2f;
        bsdf.w_out = {normalize({0.5f, 0.2f, 0.6f})};
        bsdf.shading_x = {1, 0, 0};
        bsdf.shading_y = {0, 1, 0};
        bsdf.shading_z = {0, 0, 1};
    }
};

const Stage& stage() {
    static const Stage stage;
    return stage;
}

void make_record_of_4096_rays(benchmark::State& state) {
    const FlushDenormals flush;
    RayCounts rays;
    for (auto _ : state)
        benchmark::DoNotOptimize(
            make_record(*stage().source, stage().point, {}, {0.35f, 0.01f, 0.1f}, 1, rays));
}
BENCHMARK(make_record_of_4096_rays);

void project_all_surfels(benchmark::State& state) {
    const Surfels& s = stage().record.surfels;
    std::vector<BitRect> masks(s.count + surfel_padding), trails(s.count + surfel_padding);
    const Frame &from = stage().record.frame, &to = stage().receiver.frame;
    const Projection projection{{from.to_local({to.s}).v, from.to_local({to.t}).v, from.to_local({to.n}).v},
                                to.to_local({stage().record.position - stage().receiver.position}).v,
                                true,
                                64};
    for (auto _ : state) {
        project_surfels(s, 0, s.count, projection, masks, trails);
        benchmark::DoNotOptimize(masks.data());
    }
    state.counters["surfels"] = static_cast<double>(s.count);
}
BENCHMARK(project_all_surfels);

void reproject_record(benchmark::State& state) {
    Reprojection out;
    for (auto _ : state) {
        out.clear(false);
        reproject(stage().record, stage().receiver, out);
        benchmark::DoNotOptimize(out.radiance.data());
    }
    state.counters["gaps"] = static_cast<double>(out.gaps()) / mask_bits;
}
BENCHMARK(reproject_record);

void clear_canvas(benchmark::State& state) {
    Reprojection out;
    for (auto _ : state) {
        out.clear(false);
        benchmark::DoNotOptimize(out.radiance.data());
    }
}
BENCHMARK(clear_canvas);

/// Argument: GGX alpha in hundredths; 0: Lambert.
void tabulate_bsdf(benchmark::State& state) {
    ReceiverBsdf bsdf = stage().bsdf;
    bsdf.specular = bsdf.coated = state.range(0) > 0;
    bsdf.ggx.alpha = static_cast<float>(state.range(0)) / 100;
    BsdfTable table;
    for (auto _ : state) {
        tabulate(bsdf, all_cells, table);
        benchmark::DoNotOptimize(table.r.data());
    }
    state.counters["fine"] = static_cast<double>(table.fine_cells.size());
}
BENCHMARK(tabulate_bsdf)->Arg(0)->Arg(7)->Arg(20)->Arg(50);

void shade_square(benchmark::State& state) {
    Reprojection incident;
    incident.clear(false);
    reproject(stage().record, stage().receiver, incident);
    BsdfTable table;
    tabulate(stage().bsdf, all_cells, table);
    for (auto _ : state) benchmark::DoNotOptimize(shade(incident, table));
}
BENCHMARK(shade_square);

void choose_rays_for_gaps(benchmark::State& state) {
    Reprojection incident;
    incident.clear(false);
    reproject(stage().record, stage().receiver, incident);
    std::vector<GapRay> rays;
    for (auto _ : state) {
        choose_gap_rays(incident.covered, 4, 1, rays);
        benchmark::DoNotOptimize(rays.data());
    }
    state.counters["rays"] = static_cast<double>(rays.size());
}
BENCHMARK(choose_rays_for_gaps);

}  // namespace
}  // namespace relumine
