// SPDX-License-Identifier: Apache-2.0
// Reads Mitsuba scenes: ties the parts in mitsuba_*.cpp together.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/mitsuba_emitters.hpp"
#include "scene/mitsuba_materials.hpp"
#include "scene/mitsuba_sensor.hpp"
#include "scene/mitsuba_shapes.hpp"
#include "scene/quote.hpp"
#include "scene/readers.hpp"
#include "scene/tangents.hpp"

namespace relumine {
namespace {

std::size_t count_curved(const MitsubaElement& element) {
    std::size_t count = element.tag == "shape" && is_mitsuba_curved(element.type) ? 1 : 0;
    for (const auto& child : element.children) count += count_curved(*child);
    return count;
}

/// Fewer pieces where there are many curved shapes.
PbrtDetail detail_for(const MitsubaElement& root) {
    const std::size_t curved = count_curved(root);
    if (curved <= 32) return {256, 32};
    if (curved <= 256) return {128, 16};
    return curved <= 2048 ? PbrtDetail{64, 8} : PbrtDetail{32, 4};
}

/// The mesh's range of u and of v, which grows upwards.
std::array<Vec2, 2> uv_range(const Mesh& mesh) {
    Vec2 low{infinity, infinity}, high{-infinity, -infinity};
    for (const Vec2 uv : mesh.uvs[0]) {
        if (!std::isfinite(uv.x) || !std::isfinite(uv.y)) continue;
        low = {std::min(low.x, uv.x), std::min(low.y, 1 - uv.y)};
        high = {std::max(high.x, uv.x), std::max(high.y, 1 - uv.y)};
    }
    if (!(low.x <= high.x)) return {Vec2{0, 0}, Vec2{1, 1}};
    return {low, high};
}

/// Makes meshes of shapes, with their materials, and places them.
class ShapeBuilder {
  public:
    ShapeBuilder(MitsubaScene& scene, SceneData& out)
        : scene_(scene), out_(out), materials_(scene, out), detail_(detail_for(*scene.document.root)) {}

    void place(const MitsubaElement& shape) {
        if (shape.type == "shapegroup") return (void)group(shape);
        if (shape.type == "instance") return place_instance(shape);
        if (const std::optional<Placed> placed = make(shape))
            out_.instances.push_back({placed->mesh, placed->world_from_mesh, false});
    }
    void check_unused() { materials_.check_unused(*scene_.document.root); }

  private:
    struct Placed {
        MeshId mesh;
        Transform world_from_mesh;
    };

    void place_instance(const MitsubaElement& shape) {
        MitsubaProperties p(shape, scene_);
        const Transform world_from_group = p.transform("to_world");
        const std::vector<const MitsubaElement*> groups = p.objects("shape");
        if (groups.size() != 1 || groups[0]->type != "shapegroup")
            refuse_pbrt(shape.place, "one shapegroup in \"instance\"",
                        groups.empty() ? "none" : quote(groups[0]->type));
        for (const Placed& part : group(*groups[0])) {
            if (out_.instances.size() >= max_instances)
                refuse_pbrt(shape.place, fmt::format("at most {} instances", max_instances), "more");
            out_.instances.push_back({part.mesh, world_from_group * part.world_from_mesh, false});
        }
        p.finish();
    }

    const std::vector<Placed>& group(const MitsubaElement& shape) {
        const auto [it, inserted] = groups_.try_emplace(&shape);
        if (!inserted) return it->second;
        MitsubaProperties p(shape, scene_);
        for (const MitsubaElement* part : p.objects("shape")) {
            if (part->type == "shapegroup" || part->type == "instance")
                refuse_pbrt(part->place, "plain shapes in \"shapegroup\"", quote(part->type));
            if (const std::optional<Placed> placed = make(*part)) it->second.push_back(*placed);
        }
        p.finish();
        return it->second;
    }

    std::optional<Placed> make(const MitsubaElement& shape) {
        MitsubaProperties p(shape, scene_);
        MitsubaMesh made = make_mitsuba_mesh(p, detail_);
        Mesh& mesh = made.mesh;
        const Transform world_from_mesh = p.transform("to_world") * made.object_from_mesh;
        const std::vector<const MitsubaElement*> bsdfs = p.objects("bsdf"), emitters = p.objects("emitter");
        if (bsdfs.size() > 1)
            refuse_pbrt(shape.place, "one BSDF of the shape", fmt::format("{}", bsdfs.size()));
        if (emitters.size() > 1)
            refuse_pbrt(shape.place, "one emitter of the shape", fmt::format("{}", emitters.size()));
        for (const MitsubaElement* medium : p.objects("medium"))
            scene_.notes.warn(medium->place, "participating media are not rendered");
        p.finish();
        if (mesh.triangles.empty()) return {};
        elements_ += mesh.positions.size() + mesh.triangles.size();
        if (elements_ > max_elements)
            refuse_pbrt(shape.place, "at most 2^30 vertices and triangles in all", "more");
        const auto binding = materials_.bind(bsdfs.empty() ? nullptr : bsdfs[0],
                                             emitters.empty() ? nullptr : emitters[0], uv_range(mesh));
        if (!binding.visible) return {};
        mesh.material = binding.material;
        mesh.facet_tangents = !is_mitsuba_curved(shape.type);
        mesh.name = shape.id.empty() ? shape.type : shape.id;
        if (binding.inside_out) {
            for (Triangle& t : mesh.triangles) std::swap(t.vertex[1], t.vertex[2]);
            for (Vec3& n : mesh.normals) n = -n;
        }
        if (binding.normal_map) {  // Mitsuba's second axis is n × s, whichever way v goes
            add_tangents(mesh, 0);
            for (Vec4& t : mesh.tangents) t.w = 1;
        }
        out_.meshes.push_back(std::move(mesh));
        return Placed{static_cast<MeshId>(out_.meshes.size() - 1), world_from_mesh};
    }

    static constexpr std::size_t max_elements = std::size_t{1} << 30;
    static constexpr std::size_t max_instances = 100'000'000;
    MitsubaScene& scene_;
    SceneData& out_;
    MitsubaMaterials materials_;
    PbrtDetail detail_;
    std::map<const MitsubaElement*, std::vector<Placed>> groups_;
    std::size_t elements_ = 0;
};

/// Mitsuba counts edges of a path, we its scattering vertices: one less.
void note_integrator(const MitsubaElement& element, MitsubaScene& scene) {
    MitsubaProperties p(element, scene);
    const std::vector<std::string> types{"path", "volpath", "volpathmis", "direct",
                                         "aov",  "moment",  "ptracer"};
    if (std::ranges::find(types, element.type) == types.end())
        p.warn(fmt::format("integrator {} is unknown: the command chooses the method", quote(element.type)));
    const int depth = p.integer("max_depth", -1);
    if (depth < -1) p.refuse("max_depth", "-1 or a depth of at least 0", fmt::format("{}", depth));
    if (element.type == "direct")
        p.warn("integrator \"direct\" is not taken over: --max-depth 1 renders the same");
    else if (depth > 0)
        p.warn(fmt::format("\"max_depth\" {} is not taken over: --max-depth {} renders the same", depth,
                           depth - 1));
    if (p.boolean("hide_emitters", false)) p.warn("\"hide_emitters\" is not supported: lights are seen");
    for (const MitsubaElement* inner : p.objects("integrator")) note_integrator(*inner, scene);
    p.ignore({"rr_depth", "aovs", "shading_samples", "emitter_samples", "bsdf_samples", "samples_per_pass",
              "block_size", "timeout", "integrator"});
    p.finish();
}

}  // namespace

SceneData read_mitsuba(const std::string& path, const SceneOptions& options) {
    PbrtFiles files(path, options.allowed_folders);
    MitsubaScene scene{read_mitsuba_document(path, files, options.definitions), files, {}};
    const MitsubaElement& root = *scene.document.root;
    SceneData out;
    out.name = path;
    if (!scene.document.unused.empty())
        throw SceneError{
            expected_found(path, "parameters that a <default> names", quote(scene.document.unused[0]))};
    MitsubaProperties p(root, scene);
    for (const MitsubaElement* sensor : p.objects("sensor"))
        out.cameras.push_back(make_mitsuba_camera(scene, *sensor));
    ShapeBuilder shapes(scene, out);
    for (const MitsubaElement* shape : p.objects("shape")) shapes.place(*shape);
    shapes.check_unused();
    add_mitsuba_emitters(scene, p.objects("emitter"), out);
    for (const MitsubaElement* integrator : p.objects("integrator")) note_integrator(*integrator, scene);
    (void)p.objects("bsdf");  // for others to refer to
    (void)p.objects("texture");
    (void)p.objects("spectrum");
    (void)p.objects("rgb");
    p.finish();
    for (std::string& warning : scene.notes.warnings) out.warn(std::move(warning));
    return out;
}

}  // namespace relumine
