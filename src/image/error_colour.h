// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image.h"

#include <span>

namespace isophote {

/// Colour of an error in [0, 1], linear: from black over violet, red and orange to pale yellow, its lightness
/// (CIE L*) in proportion to the error, so that a grey print orders errors rightly.
vec3 errorColour(float error);

/// A picture of errors, one for each of width * height pixels.
Image errorPicture(int width, int height, std::span<const float> errors);

}  // namespace isophote
