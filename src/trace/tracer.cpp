// SPDX-License-Identifier: Apache-2.0
// The tracer on Embree: one geometry per instance at the top, meshes with several instances in scenes of
// their own.
#include "trace/tracer.hpp"

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cstring>
#include <vector>

#include "base/hash.hpp"
#include "base/instruction_set.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

struct ReleaseDevice {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
struct ReleaseGeometry {
    void operator()(RTCGeometry geometry) const { rtcReleaseGeometry(geometry); }
};
using Device = std::unique_ptr<RTCDeviceTy, ReleaseDevice>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, ReleaseScene>;
using Geometry = std::unique_ptr<RTCGeometryTy, ReleaseGeometry>;

/// The builder cuts its work by the number of task slots, and the tree's shape decides between hits at
/// exactly equal distances: a constant makes the tree the same on every machine, whatever the number of
/// threads that really work.
constexpr std::size_t build_slots = 8;

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

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
void init_context(QueryContext* context) { rtcInitRayQueryContext(context); }
RTCIntersectArguments intersect_arguments(QueryContext* context, RTCRayQueryFlags flags) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    arguments.flags = flags;
    return arguments;
}
void intersect1(RTCScene scene, RTCRayHit* query) {
    QueryContext context;
    init_context(&context);
    RTCIntersectArguments arguments = intersect_arguments(&context, RTC_RAY_QUERY_FLAG_INCOHERENT);
    rtcIntersect1(scene, query, &arguments);
}
void occluded1(RTCScene scene, RTCRay* query) {
    QueryContext context;
    init_context(&context);
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded1(scene, query, &arguments);
}
void intersect16(RTCScene scene, const int* valid, RTCRayHit16* query, Coherence coherence) {
    QueryContext context;
    init_context(&context);
    RTCIntersectArguments arguments =
        intersect_arguments(&context, coherence == Coherence::coherent ? RTC_RAY_QUERY_FLAG_COHERENT
                                                                       : RTC_RAY_QUERY_FLAG_INCOHERENT);
    rtcIntersect16(valid, scene, query, &arguments);
}
void occluded16(RTCScene scene, const int* valid, RTCRay16* query) {
    QueryContext context;
    init_context(&context);
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    rtcOccluded16(valid, scene, query, &arguments);
}
#else
using QueryContext = RTCIntersectContext;
void intersect1(RTCScene scene, RTCRayHit* query) {
    QueryContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, query);
}
void occluded1(RTCScene scene, RTCRay* query) {
    QueryContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene, &context, query);
}
void intersect16(RTCScene scene, const int* valid, RTCRayHit16* query, Coherence coherence) {
    QueryContext context;
    rtcInitIntersectContext(&context);
    if (coherence == Coherence::coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, &context, query);
}
void occluded16(RTCScene scene, const int* valid, RTCRay16* query) {
    QueryContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded16(valid, scene, &context, query);
}
#endif

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
    query.id = ray.opacity_seed;
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
    copy(rays.opacity_seed, query.id);
    LaneMask valid;
    for (std::size_t i = 0; i < packet_size; ++i) {
        valid[i] = rays.t_max[i] >= 0 ? -1 : 0;
        query.tnear[i] = 0;
        query.time[i] = 0;
        query.mask[i] = 0xffffffffu;
        query.flags[i] = 0;
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
    /// What the opacity filter needs to know; one per geometry that is not opaque.
    struct FilterData {
        const Impl* tracer;
        std::uint32_t instance;  // or no_instance where the geometry is instanced
    };

    const SceneData& scene_data;
    OpacityFunction opacity;
    Device device;
    std::vector<EmbreeScene> mesh_scenes;  // per mesh; null unless instanced
    std::vector<std::unique_ptr<FilterData>> filters;
    EmbreeScene top;

    Impl(const SceneData& scene, OpacityFunction opacity_function)
        : scene_data(scene),
          opacity(std::move(opacity_function)),
          device(rtcNewDevice(device_options().c_str())) {
        if (!device) throw Error{"ray tracing: Embree cannot start on this machine"};
    }

    Geometry mesh_geometry(const Mesh& mesh, std::uint32_t instance) {
        Geometry geometry = triangle_geometry(device.get(), mesh);
        if (scene_data.materials[index(mesh.material)].alpha_mode != AlphaMode::opaque) {
            filters.push_back(std::make_unique<FilterData>(FilterData{this, instance}));
            rtcSetGeometryUserData(geometry.get(), filters.back().get());
            rtcSetGeometryIntersectFilterFunction(geometry.get(), pass_transparent);
            rtcSetGeometryOccludedFilterFunction(geometry.get(), pass_transparent);
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
            const Geometry geometry = instance.identity
                                          ? mesh_geometry(scene_data.meshes[index(instance.mesh)], i)
                                          : instance_geometry(instance);
            rtcAttachGeometryByID(top.get(), geometry.get(), i);
        }
        rtcCommitScene(top.get());
        throw_on_error(device.get(), "building the acceleration structure");
    }

    /// Embree's filter: lets a ray pass where its hash says that the surface is not there for it.
    static void pass_transparent(const RTCFilterFunctionNArguments* args) {
        const auto& filter = *static_cast<const FilterData*>(args->geometryUserPtr);
        for (unsigned lane = 0; lane < args->N; ++lane) {
            if (args->valid[lane] == 0) continue;
            Hit hit;
            hit.u = RTCHitN_u(args->hit, args->N, lane);
            hit.v = RTCHitN_v(args->hit, args->N, lane);
            hit.triangle = RTCHitN_primID(args->hit, args->N, lane);
            hit.instance = filter.instance != no_instance ? filter.instance
                                                          : RTCHitN_instID(args->hit, args->N, lane, 0);
            const std::uint64_t surface = std::uint64_t{hit.instance} << 32 | hit.triangle;
            const auto random =
                static_cast<std::uint32_t>(hash(surface, RTCRayN_id(args->ray, args->N, lane)));
            if (unit_float(random) >= filter.tracer->opacity(hit)) args->valid[lane] = 0;
        }
    }
};

Tracer::Tracer(const SceneData& scene, OpacityFunction opacity)
    : impl_(std::make_unique<Impl>(scene, std::move(opacity))) {
    const tbb::global_control enough(tbb::global_control::max_allowed_parallelism, build_slots + 1);
    impl_->build();
}

Tracer::~Tracer() = default;

std::string Tracer::library() { return "Embree " RTC_VERSION_STRING; }

bool Tracer::asks_for_opacity() const { return !impl_->filters.empty(); }

Hit Tracer::closest_hit(const Ray& ray) const {
    RTCRayHit query;
    set_ray(query.ray, ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    intersect1(impl_->top.get(), &query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    return {query.ray.tfar, query.hit.u, query.hit.v, instance_of(query.hit.geomID, query.hit.instID[0]),
            query.hit.primID};
}

bool Tracer::occluded(const Ray& ray) const {
    RTCRay query;
    set_ray(query, ray);
    occluded1(impl_->top.get(), &query);
    return query.tfar < 0;
}

void Tracer::closest_hits(const RayLanes& rays, HitLanes& hits, Coherence coherence) const {
    alignas(64) RTCRayHit16 query;
    const LaneMask valid = set_rays(query.ray, rays);
    std::ranges::fill(query.hit.geomID, RTC_INVALID_GEOMETRY_ID);
    std::ranges::fill(query.hit.instID[0], RTC_INVALID_GEOMETRY_ID);
    intersect16(impl_->top.get(), valid.data(), &query, coherence);
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
    occluded16(impl_->top.get(), valid.data(), &query);
    for (std::size_t i = 0; i < packet_size; ++i) blocked[i] = valid[i] != 0 && query.tfar[i] < 0 ? -1 : 0;
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

}  // namespace relumine
