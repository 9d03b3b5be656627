// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/builtin.h"

#include "scene/builtin/scenes.h"

#include <algorithm>
#include <array>

namespace isophote {

std::span<const BuiltinScene> builtinScenes() {
  static constexpr std::array scenes{
      BuiltinScene{"cornell-box", "The Cornell box, 2 m wide, lit by a lamp set into its ceiling.",
                   makeCornellBox},
      BuiltinScene{"cornell-objects",
                   "A Cornell room with a glossy vase, a glass and a mirror sphere and a white box.",
                   makeCornellObjects},
      BuiltinScene{"colour-bleed",
                   "A closed room of saturated walls around a white box: 30 triangles, one point light.",
                   makeColourBleed},
      BuiltinScene{"two-rooms",
                   "A lit and a dark room with a thin wall between them, which nothing may leak through.",
                   makeTwoRooms},
      BuiltinScene{"caustic-ring", "A polished golden ring on a table and the bright curve that it casts.",
                   makeCausticRing},
      BuiltinScene{"glass-sphere", "A glass and a mirror sphere in a Cornell room.", makeGlassSphere},
      BuiltinScene{"atrium",
                   "A courtyard between two storeys of arcades, lit by a lamp, with curtains and banners.",
                   makeAtrium},
      BuiltinScene{"furnace", "Inside a glowing white sphere, where the right answer is known.", makeFurnace},
      BuiltinScene{"furnace-box", "Inside a glowing white cube, where the right answer is known.",
                   makeFurnaceBox},
  };
  return scenes;
}

const BuiltinScene* findBuiltinScene(std::string_view name) {
  const std::span<const BuiltinScene> scenes = builtinScenes();
  const auto found = std::ranges::find(scenes, name, &BuiltinScene::name);
  return found == scenes.end() ? nullptr : &*found;
}

}  // namespace isophote
