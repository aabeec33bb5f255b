// SPDX-License-Identifier: Apache-2.0
// Small scenes of emissive quads for the cache's tests: what a record sees is known in closed form.
#pragma once

#include <memory>

#include "base/executor.hpp"
#include "cache/reproject.hpp"

namespace relumine::testing {

/// A parallelogram that emits on both sides: corner, corner + a, corner + a + b, corner + b.
struct Quad {
    Vec3 corner, a, b;
    Spectrum radiance;
};

/// Quads under an environment of constant radiance. Gather rays bring back emission alone.
class Stage {
  public:
    Stage(const std::vector<Quad>& quads, Spectrum sky) {
        for (const Quad& quad : quads) add(quad);
        if (!is_black(sky)) {
            scene_.environment.emplace();
            scene_.environment->width = 2;
            scene_.environment->height = 1;
            scene_.environment->radiance.assign(2, sky);
        }
        const FlushDenormals flush;
        tracer_ = std::make_unique<Tracer>(scene_, [](const Hit&) { return 1.0f; });
        lights_ = std::make_unique<LightSampler>(scene_, LightSelection{});
        bsdfs_ = std::make_unique<UniformBsdfs>(scene_, Masking::correlated);
        transport_ =
            std::make_unique<Transport>(Transport{scene_, *tracer_, *lights_, *bsdfs_, Masking::correlated});
        source_ = std::make_unique<IncidentRadiance>(IncidentRadiance{*transport_, 1, 0});
    }

    [[nodiscard]] const IncidentRadiance& source() const { return *source_; }

    [[nodiscard]] Record record(Vec3 position, Vec3 normal, int side = 64, float reach = 0.1f,
                                std::uint64_t key = 1) const {
        const FlushDenormals flush;
        RayCounts rays;
        return make_record(*source_, {position, frame_around(normal), 1e-5f, 0}, {side, 16},
                           {0, reach, reach}, key, rays);
    }

  private:
    void add(const Quad& quad) {
        Mesh mesh;
        mesh.material = MaterialId{static_cast<std::uint32_t>(scene_.materials.size())};
        mesh.positions = {quad.corner, quad.corner + quad.a, quad.corner + quad.a + quad.b,
                          quad.corner + quad.b};
        mesh.triangles = {{{0, 1, 2}}, {{0, 2, 3}}};
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
