// SPDX-License-Identifier: Apache-2.0
// The steps of a path in lanes against their scalar definitions, bit by bit, on every instruction set that
// this machine has; built a second time with one lane alone (tests/CMakeLists.txt).
#include "radiance/path_lanes.hpp"

#include <gtest/gtest.h>

#include "base/executor.hpp"
#include "radiance/direct_light.hpp"
#include "tests/targets.hpp"

namespace relumine {
namespace {

using testing::on_every_target;

constexpr std::uint64_t packets = 120;

float uniform(std::uint64_t i, std::uint64_t what, float low = 0, float high = 1) {
    return low + (high - low) * unit_float(static_cast<std::uint32_t>(hash(i, what)));
}
Vec3 random_vector(std::uint64_t i, std::uint64_t what) {
    return {uniform(i, what, -1, 1), uniform(i, what + 1, -1, 1), uniform(i, what + 2, -1, 1)};
}

constexpr std::uint32_t triangles_per_mesh = 8;

/// Triangles in disorder, some with normals, some instanced and mirrored, of every material that the kernels
/// know, two of which shine, under a sky.
class Disorder {
  public:
    explicit Disorder(Masking masking, float anisotropy = 1) {
        scene_.bounds.add({-3, -3, -3});
        scene_.bounds.add({3, 3, 3});
        add_mesh({.metallic = 0, .specular = 0}, false);        // Lambert
        add_mesh({.metallic = 1, .roughness = 0.4f}, true);     // metal
        add_mesh({.metallic = 0.5f, .roughness = 0.6f}, true);  // layers
        add_mesh({.metallic = 0.3f, .roughness = 0.5f, .specular = 0}, false);
        add_mesh({.metallic = 1, .roughness = 0.3f, .anisotropy = 0.7f * anisotropy}, true);
        add_mesh({.metallic = 0.4f, .roughness = 0.5f, .anisotropy = 0.5f * anisotropy, .rotation = 0.6f},
                 false);
        add_mesh({.metallic = 0, .emission = Spectrum{2}, .specular = 0}, false);
        add_mesh({.metallic = 0, .emission = Spectrum{1}, .double_sided = true, .specular = 0}, false);
        for (Instance& instance : scene_.instances) instance.identity = true;
        for (const std::uint32_t mesh : {1u, 4u, 6u}) add_mirrored(mesh);
        scene_.environment = Environment{4, 2, {8, Spectrum{0.5f}}, 0};
        scene_.environment->radiance[2] = Spectrum{5};
        const FlushDenormals flush;
        tracer_ = std::make_unique<Tracer>(scene_, [](const Hit&) { return 1.0f; });
        lights_ = std::make_unique<LightSampler>(scene_, LightSelection{});
        bsdfs_ = std::make_unique<UniformBsdfs>(scene_, masking);
        transport_ = std::make_unique<Transport>(Transport{scene_, *tracer_, *lights_, *bsdfs_, masking});
    }

    [[nodiscard]] const Transport& transport() const { return *transport_; }
    [[nodiscard]] PathState random_path(std::uint64_t i) const {
        PathState path;
        path.hit = {uniform(i, 1, 0.1f, 2), 0, 0, 0, 0};
        path.hit.u = uniform(i, 2);
        path.hit.v = uniform(i, 3, 0, 1 - path.hit.u);
        path.hit.instance = static_cast<std::uint32_t>(hash(i, 4) % scene_.instances.size());
        path.hit.triangle = static_cast<std::uint32_t>(hash(i, 5) % triangles_per_mesh);
        path.ray = {random_vector(i, 6), {normalize(random_vector(i, 9))}};
        path.depth = 5;  // where Russian roulette asks
        path.throughput = {uniform(i, 12, 0, 2), uniform(i, 13), uniform(i, 14)};
        return path;
    }

  private:
    struct Look {
        float metallic = 0, roughness = 1;
        Spectrum emission{};
        bool double_sided = false;
        float specular = 1, anisotropy = 0, rotation = 0;
    };
    void add_mesh(const Look& look, bool normals) {
        const auto seed = std::uint64_t{100} * scene_.meshes.size() + 1000;
        Material material;
        material.base_color = {0.8f, 0.5f, 0.3f};
        material.metallic = look.metallic;
        material.roughness = look.roughness;
        material.emission = look.emission;
        material.double_sided = look.double_sided;
        material.specular = look.specular;
        material.anisotropy = look.anisotropy;
        material.anisotropy_rotation = look.rotation;
        Mesh mesh;
        mesh.material = MaterialId{static_cast<std::uint32_t>(scene_.materials.size())};
        for (std::uint32_t t = 0; t < triangles_per_mesh; ++t) {
            const Vec3 center = random_vector(seed + t, 1) * 3;
            for (std::uint64_t corner = 0; corner < 3; ++corner) {
                mesh.positions.push_back(center + random_vector(seed + t, 4 + 3 * corner));
                if (normals) mesh.normals.push_back(normalize(random_vector(seed + t, 20 + 3 * corner)));
                const Vec3 u = random_vector(seed + t, 40 + 3 * corner), along = normalize(u);
                if (look.anisotropy > 0 && normals)
                    mesh.tangents.push_back({along.x, along.y, along.z, t % 2 == 0 ? 1.0f : -1.0f});
                if (look.anisotropy > 0 && t < 6) mesh.uvs[0].push_back({u.x, u.y});
                if (look.anisotropy > 0 && t >= 6) mesh.uvs[0].push_back({});  // no direction
            }
            mesh.triangles.push_back({{3 * t, 3 * t + 1, 3 * t + 2}});
        }
        scene_.instances.push_back({MeshId{static_cast<std::uint32_t>(scene_.meshes.size())}, {}, false});
        scene_.materials.push_back(material);
        scene_.meshes.push_back(std::move(mesh));
    }
    void add_mirrored(std::uint32_t mesh) {
        Instance instance;
        instance.mesh = MeshId{mesh};
        instance.world_from_object.m = {{{-1.5, 0.2, 0, 1}, {0.1, 1, 0.3, 0}, {0, 0, 0.7, -1}}};
        scene_.instances.push_back(instance);
    }

    SceneData scene_;
    std::unique_ptr<Tracer> tracer_;
    std::unique_ptr<LightSampler> lights_;
    std::unique_ptr<UniformBsdfs> bsdfs_;
    std::unique_ptr<Transport> transport_;
};

/// Sixteen paths at random hits, in lanes and one by one.
struct Packet {
    std::array<PathState, packet_size> paths;
    std::vector<Vertex> vertices;  // make_vertex of the paths
    TriangleLanes triangles{};
    LayerLanes layers{};
    PathLanes lanes{};
    ScatterNumbers numbers;
    Lanes<float> light_x, light_y;
    LaneMask all;

    Packet(const Disorder& scene, std::uint64_t seed) {
        const Transport& t = scene.transport();
        all.fill(-1);
        numbers.may_end = true;
        for (std::size_t i = 0; i < packet_size; ++i) {
            const std::uint64_t key = hash(seed, i);
            paths[i] = scene.random_path(key);
            vertices.push_back(make_vertex(t, paths[i], {}));
            lanes.set(i, paths[i]);
            const ShadingTriangle triangle = shading_triangle(t.scene, paths[i].hit);
            triangles.set(i, triangle, paths[i].hit, paths[i].ray.direction.v);
            const MetallicRoughness* found = t.uniform_bsdfs.find_layers(
                t.scene.meshes[index(t.scene.instances[paths[i].hit.instance].mesh)].material);
            layers.set(i, *found);
            if (is_anisotropic(found->ggx))
                set_anisotropy(i, triangle.lobe_axis, found->ggx, triangles, layers);
            layers.specular = layers.specular || !is_black(found->specular_f90);
            numbers.lobe[i] = uniform(key, 20);
            numbers.direction_x[i] = uniform(key, 21);
            numbers.direction_y[i] = uniform(key, 22);
            numbers.roulette[i] = uniform(key, 23);
            light_x[i] = uniform(key, 24);
            light_y[i] = uniform(key, 25);
        }
    }
};

/// Runs `check(scene, packet)` for many packets on every instruction set.
template <typename Check>
void for_random_packets(const Check& check) {
    for (const Masking masking : {Masking::correlated, Masking::separable})
        for (const float anisotropy : {0.0f, 1.0f}) {
            const Disorder scene(masking, anisotropy);
            int stretched = 0;
            on_every_target([&] {
                for (std::uint64_t seed = 0; seed < packets; ++seed) {
                    const Packet packet(scene, seed);
                    stretched += packet.layers.stretched && packet.triangles.oriented ? 1 : 0;
                    check(scene, packet);
                }
            });
            EXPECT_EQ(stretched > 0, anisotropy > 0);
        }
}

TEST(PathLanes, VerticesHaveTheBitsOfSurfacePoints) {
    for_random_packets([](const Disorder&, const Packet& packet) {
        VertexLanes v;
        locate(packet.triangles, v);
        for (std::size_t i = 0; i < packet_size; ++i) {
            const SurfacePoint& p = packet.vertices[i].point;
            EXPECT_EQ(v.position[i], p.position);
            EXPECT_EQ(v.geometric_normal[i], p.geometric_normal);
            EXPECT_EQ(v.s[i], p.frame.s);
            EXPECT_EQ(v.t[i], p.frame.t);
            EXPECT_EQ(v.n[i], p.frame.n);
            EXPECT_EQ(v.offset[i], p.offset);
            EXPECT_EQ(v.w_out[i], packet.vertices[i].w_out.v);
        }
    });
}

TEST(PathLanes, LightSamplesHaveTheBitsOfSingleOnes) {
    int drawn = 0;
    for_random_packets([&](const Disorder& scene, const Packet& packet) {
        const LightSampler& lights = scene.transport().lights;
        LightLanes samples{};
        lights.sample(packet.lanes.ray.origin, packet.light_x, packet.light_y, packet.all, samples);
        for (std::size_t i = 0; i < packet_size; ++i) {
            const auto s = lights.sample(packet.lanes.ray.origin[i], {packet.light_x[i], packet.light_y[i]});
            ASSERT_EQ(samples.drawn[i] != 0, s.has_value());
            if (!s) continue;
            ++drawn;
            EXPECT_EQ(samples.w_in[i], s->w_in.v);
            EXPECT_EQ(samples.distance[i], s->distance);
            EXPECT_EQ(samples.target[i], s->target);
            EXPECT_EQ(samples.radiance[i], s->radiance);
            EXPECT_EQ(samples.pdf[i], s->pdf);
            EXPECT_EQ(samples.delta[i] != 0, s->delta);
        }
    });
    EXPECT_GT(drawn, 1000);
}

TEST(PathLanes, ProposalsHaveTheBitsOfSingleOnes) {
    int proposed = 0;
    for_random_packets([&](const Disorder& scene, const Packet& packet) {
        VertexLanes vertices;
        LightLanes lights{};
        ShadowLanes shadows{};
        locate(packet.triangles, vertices);
        scene.transport().lights.sample(vertices.position, packet.light_x, packet.light_y, packet.all,
                                        lights);
        propose_direct_light(vertices, packet.layers, lights, packet.lanes.throughput, shadows);
        for (std::size_t i = 0; i < packet_size; ++i) {
            const auto light = propose_direct_light(scene.transport(), packet.vertices[i],
                                                    {{packet.light_x[i], packet.light_y[i]}, 0});
            ASSERT_EQ(shadows.rays.t_max[i] >= 0, light.has_value());
            if (!light) continue;
            ++proposed;
            EXPECT_EQ(shadows.rays.origin[i], light->shadow_ray.origin);
            EXPECT_EQ(shadows.rays.direction[i], light->shadow_ray.direction.v);
            EXPECT_EQ(shadows.rays.t_max[i], light->shadow_ray.t_max);
            EXPECT_EQ(shadows.radiance[i], packet.paths[i].throughput * light->reflected);
        }
    });
    EXPECT_GT(proposed, 1000);
}

TEST(PathLanes, ScatteredPathsHaveTheBitsOfSingleOnes) {
    int survived = 0;
    for_random_packets([&](const Disorder&, const Packet& packet) {
        VertexLanes vertices;
        PathLanes lanes = packet.lanes;
        locate(packet.triangles, vertices);
        scatter(vertices, packet.layers, packet.numbers, packet.all, lanes);
        for (std::size_t i = 0; i < packet_size; ++i) {
            const ScatterNumbers& n = packet.numbers;
            PathState path = packet.paths[i];
            const Vertex& vertex = packet.vertices[i];
            const BsdfRandom u{n.lobe[i], {n.direction_x[i], n.direction_y[i]}};
            scatter(path, vertex, sample(vertex.bsdf, vertex.w_out, u), 0);
            path.alive = path.alive && survives(path, n.roulette[i]);
            ASSERT_EQ(lanes.alive[i] != 0, path.alive);
            if (!path.alive) continue;
            ++survived;
            EXPECT_EQ(lanes.throughput[i], path.throughput);
            EXPECT_EQ(lanes.bsdf_pdf[i], path.bsdf_pdf);
            EXPECT_EQ(lanes.ray.origin[i], path.ray.origin);
            EXPECT_EQ(lanes.ray.direction[i], path.ray.direction.v);
            EXPECT_EQ(lanes.ray.t_max[i], path.ray.t_max);
        }
    });
    EXPECT_GT(survived, 1000);
}

TEST(PathLanes, OtherLanesAreLeftAlone) {
    for_random_packets([](const Disorder&, const Packet& packet) {
        VertexLanes vertices;
        PathLanes lanes = packet.lanes;
        LaneMask some{};
        for (std::size_t i = 0; i < packet_size; i += 3) some[i] = -1;
        locate(packet.triangles, vertices);
        scatter(vertices, packet.layers, packet.numbers, some, lanes);
        for (std::size_t i = 0; i < packet_size; ++i) {
            if (some[i] != 0) continue;
            EXPECT_EQ(lanes.alive[i], packet.lanes.alive[i]);
            EXPECT_EQ(lanes.throughput[i], packet.lanes.throughput[i]);
            EXPECT_EQ(lanes.ray.direction[i], packet.lanes.ray.direction[i]);
        }
    });
}

/// Paths that bounce about in the disorder: in a batch, they change packets as others end.
TEST(PathBatch, PathsBringBackWhatTheyDoAlone) {
    const Disorder scene(Masking::correlated);
    const FlushDenormals flush;
    const Transport& t = scene.transport();
    std::array<PathPacket, batch_packets> paths;
    std::array<StreamPacket, batch_packets> streams;
    for (std::size_t p = 0; p < batch_packets; ++p)
        for (std::size_t i = 0; i < packet_size; ++i) {
            PathState& path = paths[p][i];
            path.ray = {{0, 0, 0}, {normalize(random_vector(hash(p, i), 1))}};
            path.hit = t.tracer.closest_hit(path.ray);
            streams[p][i] =
                pixel_stream(1, static_cast<int>(i), 0, static_cast<std::uint32_t>(p), 8, PointSet::sobol);
        }
    std::array<RadiancePacket, batch_packets> together, alone;
    RayCounts rays, rays_alone;
    path_radiance(t, paths, 20, streams, together, rays);
    for (std::size_t p = 0; p < batch_packets; ++p)
        path_radiance(t, {&paths[p], 1}, 20, {&streams[p], 1}, {&alone[p], 1}, rays_alone);
    double sum = 0;
    for (std::size_t p = 0; p < batch_packets; ++p)
        for (std::size_t i = 0; i < packet_size; ++i) {
            const float mine = alone[p][i].total().g;
            EXPECT_NEAR(together[p][i].total().g, mine, 1e-4f * (1 + mine)) << p << ' ' << i;
            sum += mine;
        }
    EXPECT_GT(sum, 10);
    EXPECT_EQ(rays.total(), rays_alone.total());
}

}  // namespace
}  // namespace relumine
