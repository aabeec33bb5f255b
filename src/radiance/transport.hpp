// SPDX-License-Identifier: Apache-2.0
// What every light-carrying step needs to know.
#pragma once

#include "shading/bsdf.hpp"
#include "shading/light_sampler.hpp"
#include "shading/material.hpp"
#include "trace/tracer.hpp"

namespace relumine {

class RadianceField;
class CausticMap;

/// The scene as light sees it. All references outlive the value.
struct Transport {
    const SceneData& scene;
    const Tracer& tracer;
    const LightSampler& lights;
    const UniformBsdfs& uniform_bsdfs;
    Masking masking = Masking::correlated;
    const RadianceField* field = nullptr;  // light on surfaces, where a method has asked for it
    const RadianceField* guide = nullptr;  // attracts paths, where that is wanted
    const CausticMap* caustics = nullptr;  // likewise: holds what specular vertices alone part from lights
};

/// A surface point with its BSDF, seen along `w_out`.
struct Vertex {
    SurfacePoint point;
    LocalDir w_out;  // in point.frame
    Bsdf bsdf;
};

/// Whether light may pass between the viewer's side and `w_in`: directions that the shading normal allows
/// must agree with the geometric normal, so that no light comes from below the surface.
inline bool sides_agree(const SurfacePoint& point, WorldDir w_in) {
    return (dot(w_in.v, point.geometric_normal) > 0) == (dot(w_in.v, point.frame.n) > 0);
}

}  // namespace relumine
