// SPDX-License-Identifier: Apache-2.0
// pbrt's spectra reduced to linear Rec. 709 RGB, as pbrt's own film would see them.
#pragma once

#include <span>

#include "base/vec.hpp"
#include "scene/pbrt_files.hpp"
#include "scene/pbrt_parameters.hpp"

namespace relumine {

/// What a spectrum stands for; the same numbers mean different things.
enum class PbrtSpectrumUse {
    albedo,      // clamped to [0, 1]; seen under white light
    unbounded,   // a quantity such as an index of refraction
    illuminant,  // of luminance 1 unless it is rgb, as pbrt scales lights
};

/// RGB of a parameter of type rgb, blackbody or spectrum (numbers, a name, or a file of pairs).
[[nodiscard]] Spectrum pbrt_rgb(const PbrtParameter& parameter, PbrtSpectrumUse use, PbrtFiles& files);

/// RGB of a spectrum of wavelengths (nm, increasing) and values, piecewise linear.
[[nodiscard]] Spectrum rgb_of_samples(std::span<const double> pairs, PbrtSpectrumUse use);

/// RGB of a light whose spectrum is given in the units of a constant one of luminance 1.
[[nodiscard]] Spectrum light_rgb_of_samples(std::span<const double> pairs);
/// The same of a black body's radiance in W·m⁻²·sr⁻¹·nm⁻¹.
[[nodiscard]] Spectrum blackbody_radiance_rgb(double kelvin);

/// RGB of a blackbody at `kelvin`, luminance 1.
[[nodiscard]] Spectrum blackbody_rgb(double kelvin);

/// Linear RGB between primaries: `rgb` in `space`, to Rec. 709.
[[nodiscard]] Spectrum to_rec709(Spectrum rgb, PbrtColorSpace space, PbrtSpectrumUse use);

}  // namespace relumine
