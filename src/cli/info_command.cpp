// SPDX-License-Identifier: Apache-2.0
// `relumine info`: what a scene holds.
#include <nlohmann/json.hpp>

#include "cli/command.hpp"
#include "cli/console.hpp"
#include "cli/render_options.hpp"
#include "cli/report.hpp"
#include "relumine/scene.hpp"

namespace relumine::cli {

ExitCode run_info(const Arguments& arguments) {
    CLI::App app("Tells what SCENE holds: triangles, materials, lights, cameras, memory, warnings.",
                 "relumine info");
    std::string file;
    bool json = false;
    add_file(app, {"SCENE", "", ".gltf, .glb, .pbrt, .xml, .ply, .ply.gz or .obj"}, file);
    SceneOptions options;
    add_access_options(app, options);
    app.add_flag("--json", json, "as a JSON object; keys: \"scene\" in docs/statistics.md");
    if (!parse(app, arguments)) return ExitCode::done;

    const SceneInfo info = load_scene(file, options).info();
    print(json ? json_text(scene_json(file, info), 2) + "\n" : scene_text(file, info));
    return ExitCode::done;
}

}  // namespace relumine::cli
