// SPDX-License-Identifier: Apache-2.0
// The node hierarchy of a glTF file, flattened.
#include "scene/gltf_nodes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/message.hpp"
#include "relumine/error.hpp"

namespace relumine {
namespace {

using Nodes = std::vector<tinygltf::Node>;

std::string node_place(std::size_t node) { return fmt::format("nodes[{}]", node); }

/// The parent of every node, −1 for roots.
std::vector<int> find_parents(const GltfFile& file) {
    const Nodes& nodes = file.model.nodes;
    std::vector<int> parents(nodes.size(), -1);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const int child : nodes[i].children) {
            int& parent = parents[to_size(child)];
            if (parent >= 0)
                throw SceneError{expected_found(file.where(node_place(to_size(child))), "one parent",
                                                fmt::format("nodes {} and {}", parent, i))};
            parent = static_cast<int>(i);
        }
    }
    return parents;
}

/// Where every node has at most one parent, a cycle is what no root leads to.
void check_acyclic(const GltfFile& file, const std::vector<int>& parents) {
    const Nodes& nodes = file.model.nodes;
    std::vector<bool> reached(nodes.size(), false);
    std::vector<int> stack;
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (parents[i] < 0) stack.push_back(static_cast<int>(i));
    while (!stack.empty()) {
        const std::size_t node = to_size(stack.back());
        stack.pop_back();
        reached[node] = true;
        stack.insert(stack.end(), nodes[node].children.begin(), nodes[node].children.end());
    }
    const auto cyclic = std::find(reached.begin(), reached.end(), false);
    if (cyclic != reached.end())
        throw SceneError{
            expected_found(file.where(node_place(static_cast<std::size_t>(cyclic - reached.begin()))),
                           "a hierarchy without cycles", "a node among its own ancestors")};
}

std::vector<int> scene_roots(const GltfFile& file, const std::vector<int>& parents) {
    if (!file.model.scenes.empty())
        return file.model.scenes[to_size(std::max(file.model.defaultScene, 0))].nodes;
    std::vector<int> roots;
    for (std::size_t i = 0; i < parents.size(); ++i)
        if (parents[i] < 0) roots.push_back(static_cast<int>(i));
    return roots;
}

template <std::size_t N>
std::array<double, N> array_or(const std::vector<double>& values, std::array<double, N> fallback) {
    if (values.size() == N) std::copy(values.begin(), values.end(), fallback.begin());
    return fallback;
}

std::array<double, 4> unit_quaternion(const GltfFile& file, std::size_t node) {
    auto q = array_or<4>(file.model.nodes[node].rotation, {0, 0, 0, 1});
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(length > 0.5 && length < 2))  // exporters round, but not that much
        throw SceneError{expected_found(file.where(node_place(node) + ".rotation"), "a unit quaternion",
                                        fmt::format("length {:g}", length))};
    for (double& component : q) component /= length;
    return q;
}

Transform from_matrix(const GltfFile& file, std::size_t node) {
    const auto columns = array_or<16>(file.model.nodes[node].matrix, {});
    constexpr double tolerance = 1e-6;
    const bool affine = std::abs(columns[3]) <= tolerance && std::abs(columns[7]) <= tolerance
                        && std::abs(columns[11]) <= tolerance && std::abs(columns[15] - 1) <= tolerance;
    if (!affine)
        throw SceneError{expected_found(
            file.where(node_place(node) + ".matrix"), "the last row 0, 0, 0, 1",
            fmt::format("{:g}, {:g}, {:g}, {:g}", columns[3], columns[7], columns[11], columns[15]))};
    return transform_from_columns(columns);
}

Transform parent_from_node(const GltfFile& file, std::size_t node) {
    const auto& source = file.model.nodes[node];
    if (!source.matrix.empty()) return from_matrix(file, node);
    return from_trs(array_or<3>(source.translation, {0, 0, 0}), unit_quaternion(file, node),
                    array_or<3>(source.scale, {1, 1, 1}));
}

}  // namespace

Transform from_trs(const std::array<double, 3>& t, const std::array<double, 4>& q,
                   const std::array<double, 3>& s) {
    const auto [x, y, z, w] = q;
    Transform m;
    m.m[0] = {(1 - 2 * (y * y + z * z)) * s[0], 2 * (x * y - w * z) * s[1], 2 * (x * z + w * y) * s[2], t[0]};
    m.m[1] = {2 * (x * y + w * z) * s[0], (1 - 2 * (x * x + z * z)) * s[1], 2 * (y * z - w * x) * s[2], t[1]};
    m.m[2] = {2 * (x * z - w * y) * s[0], 2 * (y * z + w * x) * s[1], (1 - 2 * (x * x + y * y)) * s[2], t[2]};
    return m;
}

std::vector<PlacedNode> place_nodes(const GltfFile& file) {
    const auto parents = find_parents(file);
    check_acyclic(file, parents);
    const auto push = [](std::vector<PlacedNode>& stack, const std::vector<int>& nodes,
                         const Transform& parent) {
        for (auto it = nodes.rbegin(); it != nodes.rend(); ++it) stack.push_back({*it, parent});
    };
    std::vector<PlacedNode> placed, stack;  // what is on the stack still carries its parent's transform
    std::vector<bool> seen(parents.size(), false);
    push(stack, scene_roots(file, parents), Transform{});
    while (!stack.empty()) {
        PlacedNode next = stack.back();
        stack.pop_back();
        const std::size_t node = to_size(next.node);
        if (seen[node])
            throw SceneError{expected_found(file.where(node_place(node)), "one place in the scene", "two")};
        seen[node] = true;
        next.world_from_node = next.world_from_node * parent_from_node(file, node);
        push(stack, file.model.nodes[node].children, next.world_from_node);
        placed.push_back(next);
    }
    return placed;
}

}  // namespace relumine
