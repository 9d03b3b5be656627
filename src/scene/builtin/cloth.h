// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/builtin/shapes.h"

namespace isophote {

// Hanging cloth, appended to a mesh: open sheets with folds, for double-sided materials. x along the rod, y
// up, z towards the onlooker, the rod at the origin.

/// Half of a pair of curtains: hangs from x = 0 to x = width, is tied to the side x = 0, flows down to
/// -height.
struct Curtain {
  float width = 1;   ///< [m]; negative: towards -x.
  float height = 3;  ///< [m]
  int folds = 6;
  float phase = 0;  ///< Of the folds [radians].
};
void addCurtain(Mesh& mesh, const Curtain& curtain);

/// A banner that hangs straight, ends in a point and waves a little.
struct Banner {
  float width = 0.8f;  ///< [m]
  float height = 2;    ///< To the point [m].
  float phase = 0;     ///< Of the waves [radians].
};
void addBanner(Mesh& mesh, const Banner& banner);

/// A strip of cloth stretched between x = -length / 2 and length / 2 that sags in the middle and folds along
/// its length.
struct Awning {
  float length = 8;    ///< [m]
  float width = 1.5f;  ///< Along z [m].
  float sag = 0.8f;    ///< [m]
  float phase = 0;     ///< [radians]
};
void addAwning(Mesh& mesh, const Awning& awning);

}  // namespace isophote
