// SPDX-License-Identifier: Apache-2.0
// The methods by name.
#include "integrators/registry.hpp"

#include "base/assert.hpp"
#include "integrators/block_cache.hpp"
#include "integrators/cached_gather.hpp"
#include "integrators/gather.hpp"
#include "integrators/path_tracer.hpp"
#include "integrators/rival_gather.hpp"

namespace relumine {
namespace {

using Maker = std::unique_ptr<Integrator> (*)(const RenderSettings&, const Transport&, const View&,
                                              bool surface_layers);

struct Method {
    const char* name;
    Maker make;
};

constexpr std::array methods{
    Method{"cache", make_block_cache},
    Method{"block-gather", make_block_gather},
    Method{"path", make_path_tracer},
    Method{"gather", make_gather},
    Method{"reproject", make_reproject},
    Method{"reproject-mc", make_reproject_mc},
    Method{"irradiance-cache", make_irradiance_cache},
    Method{"radiance-cache", make_radiance_cache},
};

}  // namespace

std::vector<std::string> integrator_names() {
    std::vector<std::string> names;
    for (const Method& method : methods) names.emplace_back(method.name);
    return names;
}

std::unique_ptr<Integrator> make_integrator(const RenderSettings& settings, const Transport& transport,
                                            const View& view, bool surface_layers) {
    const auto named = [&](const Method& method) { return settings.method == method.name; };
    const auto* method = std::ranges::find_if(methods, named);
    RELUMINE_ASSERT(method != methods.end());
    return method->make(settings, transport, view, surface_layers);
}

}  // namespace relumine
