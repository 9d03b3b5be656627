// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

namespace isophote {

// Colour spaces that follow the eye. All take linear Rec.709 with white (1, 1, 1), illuminant D65.

/// CIE 1931 XYZ relative to white: (1, 1, 1) is white.
vec3 relativeXyzFromLinear(vec3 linear);
vec3 linearFromRelativeXyz(vec3 xyz);

/// CIE 1976 L*a*b*: L* of white is 100.
vec3 labFromLinear(vec3 linear);
/// The inverse; colours outside the screen's gamut have channels outside [0, 1].
vec3 linearFromLab(vec3 lab);

/// YCxCz, an opponent space that is linear in light, so that blurring in it is right: Yy = 116 Y - 16, Cx =
/// 500 (X - Y), Cz = 200 (Y - Z) of the relative XYZ.
vec3 ycxczFromLinear(vec3 linear);
vec3 linearFromYcxcz(vec3 ycxcz);

}  // namespace isophote
