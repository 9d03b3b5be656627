// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"

#include <vector>

namespace isophote {

/// Pixels that a degree of the viewer's field of view holds: a screen 0.7 m wide with 3840 pixels, seen from
/// 0.7 m.
inline constexpr float kDefaultPixelsPerDegree = 67.0f;

/// How much each pixel seems to change where a viewer switches between two pictures, 0 (not at all) to 1:
/// FLIP for pictures of limited range (Andersson et al. 2020, "FLIP: A Difference Evaluator for Alternating
/// Images"). Both are as shown: sRGB-encoded, channels in [0, 1] (displayed()), of one size. The measure is
/// symmetric. Beyond the edge the outermost pixels count as repeated.
std::vector<float> flipErrors(const Image& shownA, const Image& shownB,
                              float pixelsPerDegree = kDefaultPixelsPerDegree);

}  // namespace isophote
