// SPDX-License-Identifier: Apache-2.0
// Reads pbrt-v4 scenes: ties the parts in pbrt_*.cpp together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "scene/pbrt_camera.hpp"
#include "scene/pbrt_lights.hpp"
#include "scene/pbrt_materials.hpp"
#include "scene/pbrt_parser.hpp"
#include "scene/pbrt_shapes.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"

namespace relumine {
namespace {

/// Fewer pieces where there are many curved shapes.
PbrtDetail detail_for(const PbrtScene& scene) {
    std::size_t curved = 0;
    const auto count = [&](const std::vector<PbrtShape>& shapes) {
        curved += static_cast<std::size_t>(std::ranges::count_if(shapes, [](const PbrtShape& shape) {
            return is_pbrt_quadric(shape.entity.type) || shape.entity.type == "bilinearmesh";
        }));
    };
    count(scene.shapes);
    for (const auto& [name, shapes] : scene.objects) count(shapes);
    if (curved <= 32) return {256, 32};
    if (curved <= 256) return {128, 16};
    return curved <= 2048 ? PbrtDetail{64, 8} : PbrtDetail{32, 4};
}

std::array<Vec2, 2> uv_range(const Mesh& mesh) {
    if (mesh.uvs[0].empty()) return {Vec2{0, 0}, Vec2{1, 1}};
    Vec2 low{infinity, infinity}, high{-infinity, -infinity};
    for (const Vec2 uv : mesh.uvs[0]) {
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) continue;
        low = {std::min(low.x, uv.x), std::min(low.y, 1 - uv.y)};
        high = {std::max(high.x, uv.x), std::max(high.y, 1 - uv.y)};
    }
    if (!(low.x <= high.x)) return {Vec2{0, 0}, Vec2{1, 1}};
    return {low, high};
}

double triangle_area(const Mesh& mesh, const Triangle& t, const Transform& world_from_object) {
    const Vec3 a = world_from_object.point(mesh.positions[t.vertex[0]]);
    const Vec3 b = world_from_object.point(mesh.positions[t.vertex[1]]);
    const Vec3 c = world_from_object.point(mesh.positions[t.vertex[2]]);
    return 0.5 * double{length(cross(b - a, c - a))};
}

void turn_inside_out(Mesh& mesh) {
    for (Triangle& t : mesh.triangles) std::swap(t.vertex[1], t.vertex[2]);
    for (Vec3& n : mesh.normals) n = -n;
}

/// Makes meshes of shapes, with their materials.
class ShapeBuilder {
  public:
    ShapeBuilder(PbrtScene& scene, PbrtFiles& files, SceneData& out)
        : scene_(scene),
          files_(files),
          out_(out),
          materials_(scene, files, out),
          detail_(detail_for(scene)) {}

    void place_all() {
        for (const PbrtShape& shape : scene_.shapes)
            for (const MeshId id : meshes(shape, shape.world_from_object))
                out_.instances.push_back({id, shape.world_from_object, false});
        for (const PbrtInstance& instance : scene_.instances) place_object(instance);
        materials_.check_unused();
    }

  private:
    struct Placed {
        MeshId mesh;
        Transform object_from_mesh;
    };

    void place_object(const PbrtInstance& instance) {
        const auto it = scene_.objects.find(instance.object);
        if (it == scene_.objects.end()) {
            std::vector<std::string> names;
            for (const auto& [name, shapes] : scene_.objects) names.push_back(name);
            refuse_pbrt(instance.place, "the name of an object",
                        quote(instance.object) + did_you_mean(instance.object, names));
        }
        const auto [placed, inserted] = objects_.try_emplace(instance.object);
        if (inserted)
            for (const PbrtShape& shape : it->second)
                for (const MeshId id : meshes(shape, shape.world_from_object))
                    placed->second.push_back({id, shape.world_from_object});
        for (const Placed& part : placed->second) {
            if (out_.instances.size() >= max_instances)
                refuse_pbrt(instance.place, fmt::format("at most {} instances", max_instances), "more");
            out_.instances.push_back(
                {part.mesh, instance.world_from_instance * part.object_from_mesh, false});
        }
    }

    /// The shape's meshes: one for each material, which is one but for lights given by power.
    std::vector<MeshId> meshes(const PbrtShape& shape, const Transform& world_from_object) {
        const std::string key = share_key(shape);
        if (const auto it = shared_.find(key); it != shared_.end()) return {it->second};
        Mesh mesh = make_pbrt_mesh(shape, detail_, materials_.needs_uv(shape), files_, scene_);
        if (mesh.triangles.empty()) return {};
        spend(mesh, shape);
        const bool patches = shape.entity.type == "bilinearmesh";  // each is a light: the mean of their areas
        if (materials_.by_power(shape) && !is_pbrt_quadric(shape.entity.type) && !patches)
            return power_meshes(shape, mesh, world_from_object);
        double area = 0;
        for (const Triangle& t : mesh.triangles) area += triangle_area(mesh, t, world_from_object);
        if (patches) area /= std::max(1.0, double(shape.entity.parameters.indices("indices").size() / 4));
        return add(shape, std::move(mesh), area, key);
    }

    /// Equal for quadrics that may share a mesh; "" for other shapes.
    [[nodiscard]] std::string share_key(const PbrtShape& shape) const {
        if (!is_pbrt_quadric(shape.entity.type) || materials_.by_power(shape)) return "";
        return fmt::format("{} {} {}:{} {}\n{}", shape.entity.type, shape.reverse_orientation,
                           shape.material.number, shape.material.name,
                           shape.area_light ? static_cast<long>(*shape.area_light) : -1L,
                           shape.entity.parameters.fingerprint());
    }

    /// Each triangle is a light of that power, as in pbrt; those of equal area share a mesh.
    std::vector<MeshId> power_meshes(const PbrtShape& shape, const Mesh& mesh,
                                     const Transform& world_from_object) {
        std::map<std::string, Mesh> by_area;
        std::map<std::string, double> areas;
        for (const Triangle& t : mesh.triangles) {
            const double area = triangle_area(mesh, t, world_from_object);
            const std::string key = fmt::format("{:.4g}", area);
            const auto [part, inserted] = by_area.try_emplace(key);
            if (inserted) {
                if (by_area.size() > max_powers)
                    refuse_pbrt(
                        shape.entity.parameters.place(),
                        fmt::format("at most {} areas of triangles in a light given by power", max_powers),
                        "more");
                part->second = mesh;
                part->second.triangles.clear();
                areas[key] = area;
            }
            part->second.triangles.push_back(t);
        }
        std::vector<MeshId> ids;
        for (auto& [key, part] : by_area)
            for (const MeshId id : add(shape, std::move(part), areas[key], "")) ids.push_back(id);
        return ids;
    }

    std::vector<MeshId> add(const PbrtShape& shape, Mesh mesh, double area, const std::string& key) {
        const PbrtMaterials::Binding binding = materials_.bind(shape, uv_range(mesh), area);
        if (!binding.visible) return {};
        mesh.material = binding.material;
        if (binding.inside_out) turn_inside_out(mesh);
        mesh.projection = make_projection(binding.mapping.value_or(PbrtMapping{}), binding.axis,
                                          is_pbrt_quadric(shape.entity.type));
        out_.meshes.push_back(std::move(mesh));
        const auto id = static_cast<MeshId>(out_.meshes.size() - 1);
        if (!key.empty()) shared_[key] = id;
        return {id};
    }

    void spend(const Mesh& mesh, const PbrtShape& shape) {
        elements_ += mesh.positions.size() + mesh.triangles.size();
        if (elements_ > max_elements)
            refuse_pbrt(shape.entity.parameters.place(), "at most 2^30 vertices and triangles in all",
                        "more");
    }

    static constexpr std::size_t max_elements = std::size_t{1} << 30;
    static constexpr std::size_t max_instances = 100'000'000;
    static constexpr std::size_t max_powers = 1000;
    PbrtScene& scene_;
    PbrtFiles& files_;
    SceneData& out_;
    PbrtMaterials materials_;
    PbrtDetail detail_;
    std::map<std::string, std::vector<Placed>> objects_;
    std::map<std::string, MeshId> shared_;
    std::size_t elements_ = 0;
};

/// pbrt stops paths after five bounces unless told otherwise; we say how to get the same.
void note_depth(PbrtScene& scene) {
    if (!scene.integrator || !scene.integrator->parameters.has("maxdepth")) return;
    const int depth = scene.integrator->parameters.integer("maxdepth", 5);
    scene.warn(scene.integrator->parameters.place(),
               fmt::format("\"maxdepth\" {0} is not taken over: --max-depth {0} renders the same", depth));
}

/// The command decides on samples; we say how to get as many.
void note_samples(PbrtScene& scene) {
    if (!scene.sampler) return;
    const PbrtParameters& p = scene.sampler->parameters;
    const bool strata = p.has("xsamples") || p.has("ysamples");
    if (!strata && !p.has("pixelsamples")) return;
    const std::int64_t count = strata ? std::int64_t{p.integer("xsamples", 4)} * p.integer("ysamples", 4)
                                      : std::int64_t{p.integer("pixelsamples", 16)};
    scene.warn(p.place(),
               fmt::format("{0} samples per pixel are not taken over: --spp {0} takes as many", count));
}

}  // namespace

SceneData read_pbrt(const std::string& path, const SceneOptions& options) {
    PbrtFiles files(path, options.allowed_folders);
    PbrtScene scene = parse_pbrt(path, files);
    SceneData out;
    out.name = path;
    out.cameras.push_back(make_pbrt_camera(scene));
    const double ratio = pbrt_imaging_ratio(scene);
    ShapeBuilder(scene, files, out).place_all();
    add_pbrt_lights(scene, files, out);
    scale_lights(out, static_cast<float>(ratio));
    note_depth(scene);
    note_samples(scene);
    for (std::string& warning : scene.warnings) out.warn(std::move(warning));
    return out;
}

}  // namespace relumine
