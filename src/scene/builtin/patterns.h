// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

// Textures by computation. Each tiles without a seam and is the same on every machine.

/// Worn stone slabs in rows, every other row shifted by half a slab, with joints; `blocks` slabs across and
/// twice as many rows. Linear colours.
Texture stoneSlabs(std::string name, int size, int blocks, vec3 colour, vec3 joint);

/// A board of `squares` x `squares` polished stones in two colours with veins. `squares` is even.
Texture chequer(std::string name, int size, int squares, vec3 light, vec3 dark);

/// A sprig of leaves on nothing: alpha is 1 on the leaves and 0 beside them.
Texture leaves(std::string name, int size, vec3 colour);

}  // namespace isophote
