// SPDX-License-Identifier: Apache-2.0
// The tracer on Embree: one geometry per instance at the top, meshes with several instances in scenes of
// their own.
#include "trace/tracer.hpp"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/executor.hpp"
#include "base/instruction_set.hpp"
#include "relumine/error.hpp"
#include "trace/embree.hpp"
#include "trace/transparency.hpp"

namespace relumine {
namespace {

/// The builder cuts its work by the number of task slots, and the tree's shape decides between hits at
/// exactly equal distances: a constant makes the tree the same on every machine, whatever the number of
/// threads that really work.
constexpr std::size_t build_slots = 8;

/// Embree builds on oneTBB whatever our executor is. Without it, one thread alone fills all slots: the same
/// tree.
std::size_t build_threads() { return default_executor() == Executor::tbb ? build_slots + 1 : 1; }

std::string device_options() {
    const std::string set = chosen_instruction_set();  // Embree knows them by the same names, but for one
    const std::string isa = set.empty() ? "" : set == "sse4" ? ",isa=sse4.2" : ",isa=" + set;
    return "threads=8,start_threads=0,set_affinity=0" + isa;
}

void throw_on_error(RTCDevice device, const char* doing) {
    const RTCError error = rtcGetDeviceError(device);
    if (error == RTC_ERROR_NONE) return;
    if (error == RTC_ERROR_OUT_OF_MEMORY)
        throw Error{fmt::format("ray tracing: not enough memory while {}", doing)};
    throw Error{fmt::format("ray tracing: Embree error {} while {}", static_cast<int>(error), doing)};
}

void set_ray(RTCRay& query, const Ray& ray) {
    query.org_x = ray.origin.x;
    query.org_y = ray.origin.y;
    query.org_z = ray.origin.z;
    query.dir_x = ray.direction.v.x;
    query.dir_y = ray.direction.v.y;
    query.dir_z = ray.direction.v.z;
    query.tnear = 0;
    query.tfar = ray.t_max;
    query.time = 0;
    query.mask = 0xffffffffu;
    query.id = 0;
    query.flags = 0;
}

/// Fills a packet; the mask tells Embree which lanes count.
LaneMask set_rays(RTCRay16& query, const RayLanes& rays) {
    const auto copy = [](const auto& from, auto* to) { std::memcpy(to, from.data(), sizeof from); };
    copy(rays.origin.x, query.org_x);
    copy(rays.origin.y, query.org_y);
    copy(rays.origin.z, query.org_z);
    copy(rays.direction.x, query.dir_x);
    copy(rays.direction.y, query.dir_y);
    copy(rays.direction.z, query.dir_z);
    copy(rays.t_max, query.tfar);
    LaneMask valid;
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = rays.t_max[i] >= 0 ? -1 : 0;
        query.tnear[i] = 0;
        query.time[i] = 0;
        query.mask[i] = 0xffffffffu;
        query.flags[i] = 0;
        query.id[i] = static_cast<unsigned>(i);
    }
    return valid;
}

RayLanes in_lanes(std::span<const Ray, packet_size> rays) {
    RayLanes lanes;
    for (std::size_t i = 0; i < packet_size; ++i) lanes.set(i, rays[i]);
    return lanes;
}

std::uint32_t instance_of(unsigned geometry, unsigned instance) {
    return instance == RTC_INVALID_GEOMETRY_ID ? geometry : instance;
}

Geometry triangle_geometry(RTCDevice device, const Mesh& mesh) {
    Geometry geometry(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.data(), 0, sizeof(Vec3), mesh.positions.size());
    rtcSetSharedGeometryBuffer(geometry.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.triangles.data(), 0, sizeof(Triangle), mesh.triangles.size());
    return geometry;
}

EmbreeScene new_scene(RTCDevice device) {
    EmbreeScene scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);  // watertight along shared edges
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
    return scene;
}

}  // namespace

struct Tracer::Impl {
    const SceneData& scene_data;
    OpacityFunction opacity;
    PaneModel panes;
    Device device;
    std::vector<EmbreeScene> mesh_scenes;  // per mesh; null unless instanced
    std::vector<std::unique_ptr<FilterData>> filters;
    EmbreeScene top;
    EmbreeScene coloured_panes;  // those of `top` alone; null where there are none
    bool has_panes = false;

    Impl(const SceneData& scene, OpacityFunction opacity_function, PaneModel pane_model)
        : scene_data(scene),
          opacity(std::move(opacity_function)),
          panes(std::move(pane_model)),
          device(rtcNewDevice(device_options().c_str())) {
        if (!device) throw Error{"ray tracing: Embree cannot start on this machine"};
    }

    [[nodiscard]] Pane pane_of(const Mesh& mesh) const { return panes.kind ? panes.kind(mesh) : Pane::none; }

    void filter_hits(RTCGeometry geometry, std::uint32_t instance, RTCFilterFunctionN closest,
                     RTCFilterFunctionN shadow) {
        filters.push_back(std::make_unique<FilterData>(FilterData{&opacity, &panes, instance}));
        rtcSetGeometryUserData(geometry, filters.back().get());
        rtcSetGeometryIntersectFilterFunction(geometry, closest);
        rtcSetGeometryOccludedFilterFunction(geometry, shadow);
    }

    Geometry mesh_geometry(const Mesh& mesh, std::uint32_t instance) {
        Geometry geometry = triangle_geometry(device.get(), mesh);
        const Pane pane = pane_of(mesh);
        if (pane != Pane::none) {
            has_panes = true;
            filter_hits(geometry.get(), instance, pass_panes, pass_light);
        } else if (scene_data.materials[index(mesh.material)].alpha_mode != AlphaMode::opaque) {
            filter_hits(geometry.get(), instance, pass_transparent, pass_transparent);
        }
        rtcCommitGeometry(geometry.get());
        return geometry;
    }

    RTCScene instanced_scene(MeshId mesh) {
        EmbreeScene& scene = mesh_scenes[index(mesh)];
        if (!scene) {
            scene = new_scene(device.get());
            const Geometry geometry = mesh_geometry(scene_data.meshes[index(mesh)], no_instance);
            rtcAttachGeometryByID(scene.get(), geometry.get(), 0);
            rtcCommitScene(scene.get());
        }
        return scene.get();
    }

    Geometry instance_geometry(const Instance& instance) {
        Geometry geometry(rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_INSTANCE));
        rtcSetGeometryInstancedScene(geometry.get(), instanced_scene(instance.mesh));
        std::array<float, 12> rows{};
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 4; ++j)
                rows[4 * i + j] = static_cast<float>(instance.world_from_object.m[i][j]);
        rtcSetGeometryTransform(geometry.get(), 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR, rows.data());
        rtcCommitGeometry(geometry.get());
        return geometry;
    }

    void build() {
        top = new_scene(device.get());
        mesh_scenes.resize(scene_data.meshes.size());
        for (std::uint32_t i = 0; i < scene_data.instances.size(); ++i) {
            const Instance& instance = scene_data.instances[i];
            const Mesh& mesh = scene_data.meshes[index(instance.mesh)];
            const Geometry geometry =
                instance.identity ? mesh_geometry(mesh, i) : instance_geometry(instance);
            rtcAttachGeometryByID(top.get(), geometry.get(), i);
            if (pane_of(mesh) != Pane::coloured) continue;
            if (!coloured_panes) coloured_panes = new_scene(device.get());
            rtcAttachGeometryByID(coloured_panes.get(), geometry.get(), i);
        }
        rtcCommitScene(top.get());
        if (coloured_panes) rtcCommitScene(coloured_panes.get());
        throw_on_error(device.get(), "building the acceleration structure");
    }
};

Tracer::Tracer(const SceneData& scene, OpacityFunction opacity, PaneModel panes)
    : impl_(std::make_unique<Impl>(scene, std::move(opacity), std::move(panes))) {
    const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, build_threads());
    impl_->build();
    asks_for_opacity_ = !impl_->filters.empty();
    has_panes_ = impl_->has_panes;
    has_coloured_panes_ = impl_->coloured_panes != nullptr;
}

Tracer::~Tracer() = default;

std::string Tracer::library() { return "Embree " RTC_VERSION_STRING; }

Hit Tracer::closest_hit(const Ray& ray) const {
    RTCRayHit query;
    set_ray(query.ray, ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    Query context(ray);
    intersect1(impl_->top.get(), &context.embree, &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.u, query.hit.v, instance_of(query.hit.geomID, query.hit.instID[0]),
            query.hit.primID};
}

bool Tracer::occluded(const Ray& ray) const {
    RTCRay query;
    set_ray(query, ray);
    Query context(ray);
    occluded1(impl_->top.get(), &context.embree, &query);
    return query.tfar < 0;
}

Spectrum Tracer::passed_light(const Ray& ray) const {
    if (!has_panes_) return Spectrum{occluded(ray) ? 0.0f : 1.0f};
    RTCRay query;
    set_ray(query, ray);
    PassedLight light;
    Query context(ray, &light);
    occluded1(impl_->top.get(), &context.embree, &query);
    return query.tfar < 0 ? Spectrum{} : light[0];
}

Spectrum Tracer::tint(const Ray& ray, float t) const {
    if (!has_coloured_panes_) return Spectrum{1};
    RTCRay query;
    set_ray(query, ray);
    query.tfar = t;
    PassedLight light;
    Query context(ray, &light);
    context.tints = true;
    occluded1(impl_->coloured_panes.get(), &context.embree, &query);
    return light[0];
}

void Tracer::closest_hits(const RayLanes& rays, HitLanes& hits, Coherence coherence) const {
    alignas(64) RTCRayHit16 query;
    const LaneMask valid = set_rays(query.ray, rays);
    std::ranges::fill(query.hit.geomID, RTC_INVALID_GEOMETRY_ID);
    std::ranges::fill(query.hit.instID[0], RTC_INVALID_GEOMETRY_ID);
    Query context(rays);
    intersect16(impl_->top.get(), &context.embree, valid.data(), &query, coherence == Coherence::coherent);
    static_assert(no_instance == RTC_INVALID_GEOMETRY_ID);
    for (std::size_t i = 0; i < packet_size; ++i) {
        hits.t[i] = query.ray.tfar[i];
        hits.u[i] = query.hit.u[i];
        hits.v[i] = query.hit.v[i];
        hits.instance[i] = instance_of(query.hit.geomID[i], query.hit.instID[0][i]);
        hits.triangle[i] = query.hit.primID[i];
    }
}

void Tracer::occluded(const RayLanes& rays, LaneMask& blocked) const {
    alignas(64) RTCRay16 query;
    const LaneMask valid = set_rays(query, rays);
    Query context(rays);
    occluded16(impl_->top.get(), &context.embree, valid.data(), &query);
    for (std::size_t i = 0; i < packet_size; ++i) blocked[i] = valid[i] != 0 && query.tfar[i] < 0 ? -1 : 0;
}

void Tracer::passed_light(const RayLanes& rays, SpectrumLanes& share) const {
    alignas(64) RTCRay16 query;
    const LaneMask valid = set_rays(query, rays);
    PassedLight light;
    Query context(rays, &light);
    occluded16(impl_->top.get(), &context.embree, valid.data(), &query);
    for (std::size_t i = 0; i < packet_size; ++i) share.set(i, query.tfar[i] < 0 ? Spectrum{} : light[i]);
}

void Tracer::closest_hits(std::span<const Ray, packet_size> rays, std::span<Hit, packet_size> hits,
                          Coherence coherence) const {
    HitLanes lanes;
    closest_hits(in_lanes(rays), lanes, coherence);
    for (std::size_t i = 0; i < packet_size; ++i)
        hits[i] = lanes.instance[i] == no_instance ? Hit{} : lanes[i];
}

void Tracer::occluded(std::span<const Ray, packet_size> rays, std::span<bool, packet_size> blocked) const {
    LaneMask lanes;
    occluded(in_lanes(rays), lanes);
    for (std::size_t i = 0; i < packet_size; ++i) blocked[i] = lanes[i] != 0;
}

void Tracer::passed_light(std::span<const Ray, packet_size> rays,
                          std::span<Spectrum, packet_size> share) const {
    if (!has_panes_) {
        LaneMask blocked;
        occluded(in_lanes(rays), blocked);
        for (std::size_t i = 0; i < packet_size; ++i) share[i] = Spectrum{blocked[i] != 0 ? 0.0f : 1.0f};
        return;
    }
    SpectrumLanes lanes;
    passed_light(in_lanes(rays), lanes);
    for (std::size_t i = 0; i < packet_size; ++i) share[i] = lanes[i];
}

}  // namespace relumine
