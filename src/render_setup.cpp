// SPDX-License-Identifier: Apache-2.0
// From settings to a frame and to what light is carried with.
#include "render_setup.hpp"

#include <fmt/format.h>

#include <charconv>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "shading/material.hpp"

namespace relumine {
namespace {

constexpr int default_width = 1024;  // pixels

const Camera& find_camera(const SceneData& scene, const std::string& wanted) {
    if (wanted.empty()) return scene.cameras.front();
    std::vector<std::string> names;
    for (const Camera& camera : scene.cameras) {
        if (camera.name == wanted) return camera;
        names.push_back(camera.name);
    }
    std::size_t number = 0;
    const auto [end, error] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (error == std::errc{} && end == wanted.data() + wanted.size() && number < scene.cameras.size())
        return scene.cameras[number];
    throw SettingsError{expected_found("camera",
                                       fmt::format("{} or an index below {}", one_of(names), names.size()),
                                       "\"" + wanted + "\"" + did_you_mean(wanted, names))};
}

struct FrameSize {
    int width, height;
};

FrameSize frame_size(const RenderSettings& settings, const Camera& camera) {
    if (settings.width > 0) return {settings.width, settings.height};
    if (camera.width > 0) return {camera.width, camera.height};
    const double aspect = camera.aspect > 0 ? camera.aspect : 4.0 / 3.0;
    return {default_width, std::clamp(static_cast<int>(std::lround(default_width / aspect)), 1, 65536)};
}

PixelRect crop_window(const RenderSettings& settings, const Camera& camera, FrameSize frame) {
    const PixelRect whole{0, 0, frame.width, frame.height};
    if (!settings.crop) return settings.width == 0 && camera.crop ? *camera.crop : whole;
    const PixelRect& c = *settings.crop;
    if (!c.empty() && c.x0 >= 0 && c.y0 >= 0 && c.x1 <= frame.width && c.y1 <= frame.height) return c;
    throw SettingsError{expected_found("crop",
                                       fmt::format("a rectangle inside 0 0 {} {}", frame.width, frame.height),
                                       fmt::format("{} {} {} {}", c.x0, c.y0, c.x1, c.y1))};
}

PointSet point_set(const RenderSettings& s) {
    if (s.sampler == "stratified") return PointSet::stratified;
    if (s.sampler == "independent") return PointSet::independent;
    const bool records = s.method == "gather" || s.method == "reproject" || s.method == "reproject-mc";
    return s.sampler == "auto" && records ? PointSet::stratified : PointSet::sobol;
}

PixelFilterKind pixel_filter(const RenderSettings& s) {
    if (s.pixel_sampling == "center") return PixelFilterKind::center;
    return s.pixel_filter == "box" ? PixelFilterKind::box : PixelFilterKind::blackman_harris;
}

View make_view(const RenderSettings& s, const Framing& f) {
    return {CameraRays(f.camera, f.width, f.height),
            PixelFilter(pixel_filter(s)),
            point_set(s),
            s.seed,
            static_cast<std::uint32_t>(s.samples_per_pixel),
            f.width,
            f.height,
            f.window};
}

Tracer make_tracer(const SceneData& scene) {
    return {
        scene,
        [&scene](const Hit& hit) {
            const Mesh& mesh = scene.meshes[index(scene.instances[hit.instance].mesh)];
            return opacity(scene, scene.materials[index(mesh.material)], texture_coordinates(scene, hit));
        },
        {[&scene](const Mesh& mesh) { return pane_kind(scene, mesh); },
         [&scene](const Hit& hit, WorldDir direction) { return pane_transmittance(scene, hit, direction); }}};
}

}  // namespace

Framing find_framing(const SceneData& scene, const RenderSettings& settings) {
    const Camera& camera = find_camera(scene, settings.camera);
    const FrameSize frame = frame_size(settings, camera);
    return {camera, frame.width, frame.height, crop_window(settings, camera, frame)};
}

RenderSetup::RenderSetup(const SceneData& scene, const RenderSettings& settings, const Framing& framing,
                         const std::function<void(const char*)>& begin_stage)
    : tracer((begin_stage("build"), make_tracer(scene))),
      lights((begin_stage("lights"), scene), {}),
      masking(settings.masking == "separable" ? Masking::separable : Masking::correlated),
      uniform_bsdfs(scene, masking),
      transport{scene, tracer, lights, uniform_bsdfs, masking},
      view(make_view(settings, framing)) {}

void RenderSetup::add_field(const RenderSettings& settings, const std::function<bool()>& stop,
                            std::uint64_t most_bytes, RayCounts& rays) {
    caustics = make_caustics(settings, transport, stop, rays);
    transport.caustics = caustics.get();
    field = make_field(settings, transport, view, stop, most_bytes, rays);
    transport.field = field.get();
    if (wants_guide(settings)) transport.guide = field.get();
}

}  // namespace relumine
