// SPDX-License-Identifier: Apache-2.0
// Normals of meshes that come without them.
#pragma once

#include <vector>

#include "scene/scene_data.hpp"

namespace relumine {

/// Twice the triangle's area along its outward normal.
[[nodiscard]] Vec3 area_vector(const Mesh& mesh, const Triangle& triangle);

/// Per vertex the unit mean of its triangles' normals; +Y where they cancel. Weighted by the angle at the
/// vertex, not by area: then a square cut along either diagonal counts the same, and the corner of a cube
/// points along its diagonal.
[[nodiscard]] std::vector<Vec3> mean_normals(const Mesh& mesh);

/// Gives the mesh smooth normals with creases: a corner whose triangle turns from the vertex's mean normal by
/// more than 40° is split off and stays flat, so that scans look smooth and boxes keep their edges.
void add_creased_normals(Mesh& mesh);

}  // namespace relumine
