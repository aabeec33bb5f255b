// SPDX-License-Identifier: Apache-2.0
// One series of two.
#include "integrators/sampled_radiance.hpp"

namespace relumine {
namespace {

/// Makes means of two, by how many rays each comes from.
class Joining {
  public:
    Joining(float rays, float other_rays)
        : here_(rays / (rays + other_rays)), there_(other_rays / (rays + other_rays)) {}

    void operator()(Spectrum& a, Spectrum b) const { a = a * here_ + b * there_; }
    void operator()(RayNoise& a, const RayNoise& b) const {
        RayNoise sum;
        sum.add(a, here_);
        sum.add(b, there_);
        a = sum;
    }

  private:
    float here_, there_;
};

}  // namespace

void FoundLight::join(const FoundLight& other) {
    if (!(other.rays > 0)) return;
    const Joining join(rays, other.rays);
    join(radiance, other.radiance);
    join(mirrored, other.mirrored);
    join(noise, other.noise);
    join(mirrored_noise, other.mirrored_noise);
    rays += other.rays;
}

void FoundResidual::join(const FoundResidual& other) {
    if (!(other.bright.rays > 0)) return;
    const Joining join(bright.rays, other.bright.rays);
    join(dim.direct, other.dim.direct);
    join(dim.indirect, other.dim.indirect);
    join(noise, other.noise);
    bright.join(other.bright);
}

}  // namespace relumine
