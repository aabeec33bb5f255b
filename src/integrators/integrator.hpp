// SPDX-License-Identifier: Apache-2.0
// The one virtual boundary: a method of computing tiles.
#pragma once

#include "base/tile.hpp"
#include "integrators/view.hpp"

namespace relumine {

/// A method. Tiles are independent; any number of threads may ask at a time.
class Integrator {
  public:
    virtual ~Integrator() = default;

    /// Adds the camera samples that `tile` names.
    virtual void render(Tile& tile) const = 0;
};

}  // namespace relumine
