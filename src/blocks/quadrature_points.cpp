// SPDX-License-Identifier: Apache-2.0
// Tabulating the points.
#include "blocks/quadrature_points.hpp"

namespace relumine {

QuadraturePoints::QuadraturePoints(const DirectionGrid& grid) {
    for (std::size_t t = 0; t < tiers.size(); ++t) {
        const DirectionGrid finer(grid.side
                                  << t);  // its Morton order has a texel's points one after the other
        for (auto* plane : {&tiers[t].x, &tiers[t].y, &tiers[t].z}) plane->resize(finer.texels);
        for (std::size_t point = 0; point < finer.texels; ++point) {
            const std::size_t to = run_position(point, points_per_texel(t));
            tiers[t].x[to] = finer.x[point];
            tiers[t].y[to] = finer.y[point];
            tiers[t].z[to] = finer.z[point];
        }
    }
}

}  // namespace relumine
