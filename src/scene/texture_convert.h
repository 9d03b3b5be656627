// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Textures of other material models turned into those that ours reads.
#pragma once

#include "image/decode.h"

namespace isophote {

/// A bump map whose white stands `height` above its black, in parts of the picture's width: becomes a normal
/// map. A picture in colour is taken for a normal map already, as many files name one so.
void normalsFromHeights(DecodedImage& image, float height);

/// Factors of a Phong exponent, in red: become glTF's roughness, in green (metallic, in blue, becomes 1).
void roughnessFromExponents(DecodedImage& image, float exponent);

/// The roughness of the GGX lobe that is as wide as Phong's with that exponent.
float roughnessFromExponent(float exponent);

}  // namespace isophote
