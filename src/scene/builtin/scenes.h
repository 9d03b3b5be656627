// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

// The makers behind builtinScenes(); what each scene is for is said in its own file.
Scene makeCornellBox();
Scene makeCornellObjects();
Scene makeColourBleed();
Scene makeTwoRooms();
Scene makeCausticRing();
Scene makeGlassSphere();
Scene makeAtrium();
Scene makeFurnace();
Scene makeFurnaceBox();

}  // namespace isophote
