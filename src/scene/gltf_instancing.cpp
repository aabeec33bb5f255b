// SPDX-License-Identifier: Apache-2.0
// Reading the places of an instanced node.
#include "scene/gltf_instancing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"
#include "scene/gltf_accessor.hpp"

namespace relumine {
namespace {

/// The attributes of one node's extension.
class Places {
  public:
    Places(const GltfFile& file, int node, const tinygltf::Value& attributes)
        : file_(file),
          place_(fmt::format("nodes[{}].extensions.EXT_mesh_gpu_instancing", node)),
          attributes_(attributes) {}

    [[nodiscard]] std::vector<Transform> read(std::size_t parts, std::size_t& budget) const;

  private:
    [[nodiscard]] int accessor(const std::string& name) const {
        return attributes_.Has(name) ? attributes_.Get(name).GetNumberAsInt() : -1;
    }
    /// Elements per attribute; the same for all. Only what stands in the file counts, not zeros without a
    /// buffer.
    [[nodiscard]] std::size_t count(std::size_t most) const;
    [[nodiscard]] std::vector<float> values(const std::string& name, int components) const {
        const int index = accessor(name);
        return index < 0 ? std::vector<float>{} : read_floats(file_, index, components);
    }

    const GltfFile& file_;
    std::string place_;
    const tinygltf::Value& attributes_;
};

std::size_t Places::count(std::size_t most) const {
    std::size_t found = 0;
    for (const char* name : {"TRANSLATION", "ROTATION", "SCALE"}) {
        if (accessor(name) < 0) continue;
        const auto& a = file_.model.accessors[to_size(accessor(name))];
        const std::string where = file_.where(fmt::format("{}.{}", place_, name));
        if (a.bufferView < 0)
            throw SceneError{expected_found(where, "an accessor with a bufferView", "none")};
        if (found != 0 && a.count != found)
            throw SceneError{expected_found(where, fmt::format("{} elements, as the others have", found),
                                            fmt::format("{}", a.count))};
        if (a.count > most)
            throw SceneError{
                expected_found(where, fmt::format("at most {} places in all", max_gltf_places), "more")};
        found = a.count;
    }
    return found;
}

std::vector<Transform> Places::read(std::size_t parts, std::size_t& budget) const {
    const std::size_t places = count(budget / std::max<std::size_t>(parts, 1));
    budget -= places * parts;
    const auto translations = values("TRANSLATION", 3), rotations = values("ROTATION", 4),
               scales = values("SCALE", 3);
    std::vector<Transform> all;
    all.reserve(places);
    for (std::size_t i = 0; i < places; ++i) {
        std::array<double, 3> t{0, 0, 0}, s{1, 1, 1};
        std::array<double, 4> q{0, 0, 0, 1};
        for (std::size_t k = 0; k < 3; ++k) {
            if (!translations.empty()) t[k] = double{translations[3 * i + k]};
            if (!scales.empty()) s[k] = double{scales[3 * i + k]};
        }
        double length2 = 0;
        for (std::size_t k = 0; k < 4; ++k) {
            if (!rotations.empty()) q[k] = double{rotations[4 * i + k]};
            length2 += q[k] * q[k];
        }
        if (!(length2 > 0.25 && length2 < 4))
            throw SceneError{expected_found(file_.where(fmt::format("{}.ROTATION: element {}", place_, i)),
                                            "a unit quaternion",
                                            fmt::format("length {:g}", std::sqrt(length2)))};
        for (double& x : q) x /= std::sqrt(length2);
        all.push_back(from_trs(t, q, s));
    }
    return all;
}

}  // namespace

std::optional<std::vector<Transform>> read_gltf_instancing(const GltfFile& file, int node, std::size_t parts,
                                                           std::size_t& budget) {
    const auto& extensions = file.model.nodes[to_size(node)].extensions;
    const auto it = extensions.find("EXT_mesh_gpu_instancing");
    if (it == extensions.end()) return std::nullopt;
    return Places{file, node, it->second.Get("attributes")}.read(parts, budget);
}

}  // namespace relumine
