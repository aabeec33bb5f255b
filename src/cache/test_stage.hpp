// SPDX-License-Identifier: Apache-2.0
// Small scenes of emissive quads for the cache's tests: what a record sees is known in closed form.
#pragma once

#include <concepts>
#include <memory>

#include "base/executor.hpp"
#include "cache/reproject.hpp"

namespace relumine::testing {

/// A parallelogram that emits on both sides: corner, corner + a, corner + a + b, corner + b.
struct Quad {
    Vec3 corner, a, b;
    Spectrum radiance;
};

/// The environment of constant radiance.
inline Environment even_sky(Spectrum radiance) { return {2, 1, {radiance, radiance}, 0}; }

/// Quads under an environment. Gather rays bring back emission alone.
class Stage {
  public:
    /// A black sky is no environment.
    Stage(const std::vector<Quad>& quads, Spectrum sky) {
        if (!is_black(sky)) scene_.environment = even_sky(sky);
        build(quads);
    }
    template <std::same_as<Environment> Sky>
    Stage(const std::vector<Quad>& quads, const Sky& sky) {
        scene_.environment = sky;
        build(quads);
    }

    [[nodiscard]] const IncidentRadiance& source() const { return *source_; }
    [[nodiscard]] const SceneData& scene() const { return scene_; }
    [[nodiscard]] const Transport& transport() const { return *transport_; }

    [[nodiscard]] Record record(Vec3 position, Vec3 normal, int side = 64, float reach = 0.1f,
                                std::uint64_t key = 1) const {
        const FlushDenormals flush;
        RayCounts rays;
        return make_record(*source_, {position, frame_around(normal), 1e-5f, 0}, {side, 16},
                           {0, reach, reach}, key, rays);
    }

  private:
    void build(const std::vector<Quad>& quads) {
        scene_.bounds.add({-1, -1, -1});
        scene_.bounds.add({1, 1, 1});
        for (const Quad& quad : quads) add(quad);
        const FlushDenormals flush;
        tracer_ = std::make_unique<Tracer>(scene_, [](const Hit&) { return 1.0f; });
        lights_ = std::make_unique<LightSampler>(scene_, LightSelection{});
        bsdfs_ = std::make_unique<UniformBsdfs>(scene_, Masking::correlated);
        transport_ =
            std::make_unique<Transport>(Transport{scene_, *tracer_, *lights_, *bsdfs_, Masking::correlated});
        source_ = std::make_unique<IncidentRadiance>(IncidentRadiance{*transport_, 1, 0});
    }

    void add(const Quad& quad) {
        Mesh mesh;
        mesh.material = MaterialId{static_cast<std::uint32_t>(scene_.materials.size())};
        mesh.positions = {quad.corner, quad.corner + quad.a, quad.corner + quad.a + quad.b,
                          quad.corner + quad.b};
        mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
        for (const Vec3 corner : mesh.positions) scene_.bounds.add(corner);
        Material material;
        material.emission = quad.radiance;
        material.double_sided = true;
        Instance instance;
        instance.mesh = MeshId{static_cast<std::uint32_t>(scene_.meshes.size())};
        instance.identity = true;
        scene_.materials.push_back(material);
        scene_.meshes.push_back(std::move(mesh));
        scene_.instances.push_back(instance);
    }

    SceneData scene_;
    std::unique_ptr<Tracer> tracer_;
    std::unique_ptr<LightSampler> lights_;
    std::unique_ptr<UniformBsdfs> bsdfs_;
    std::unique_ptr<Transport> transport_;
    std::unique_ptr<IncidentRadiance> source_;
};

}  // namespace relumine::testing
