// SPDX-License-Identifier: Apache-2.0
// What differs between Embree 3 and 4, and owners of its handles. For the tracer's own files.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include <memory>

namespace relumine {

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

#if RTC_VERSION_MAJOR >= 4
using QueryContext = RTCRayQueryContext;
inline void init_context(QueryContext* context) { rtcInitRayQueryContext(context); }
inline RTCIntersectArguments intersect_arguments(QueryContext* context, bool coherent) {
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.context = context;
    arguments.flags = coherent ? RTC_RAY_QUERY_FLAG_COHERENT : RTC_RAY_QUERY_FLAG_INCOHERENT;
    return arguments;
}
inline RTCOccludedArguments occluded_arguments(QueryContext* context) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = context;
    return arguments;
}
inline void intersect1(RTCScene scene, QueryContext* context, RTCRayHit* query) {
    RTCIntersectArguments arguments = intersect_arguments(context, false);
    rtcIntersect1(scene, query, &arguments);
}
inline void occluded1(RTCScene scene, QueryContext* context, RTCRay* query) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded1(scene, query, &arguments);
}
inline void intersect16(RTCScene scene, QueryContext* context, const int* valid, RTCRayHit16* query,
                        bool coherent) {
    RTCIntersectArguments arguments = intersect_arguments(context, coherent);
    rtcIntersect16(valid, scene, query, &arguments);
}
inline void occluded16(RTCScene scene, QueryContext* context, const int* valid, RTCRay16* query) {
    RTCOccludedArguments arguments = occluded_arguments(context);
    rtcOccluded16(valid, scene, query, &arguments);
}
#else
using QueryContext = RTCIntersectContext;
inline void init_context(QueryContext* context) { rtcInitIntersectContext(context); }
inline void intersect1(RTCScene scene, QueryContext* context, RTCRayHit* query) {
    rtcIntersect1(scene, context, query);
}
inline void occluded1(RTCScene scene, QueryContext* context, RTCRay* query) {
    rtcOccluded1(scene, context, query);
}
inline void intersect16(RTCScene scene, QueryContext* context, const int* valid, RTCRayHit16* query,
                        bool coherent) {
    if (coherent) context->flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    rtcIntersect16(valid, scene, context, query);
}
inline void occluded16(RTCScene scene, QueryContext* context, const int* valid, RTCRay16* query) {
    rtcOccluded16(valid, scene, context, query);
}
#endif

}  // namespace relumine
