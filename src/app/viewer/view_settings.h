// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/tonemap.h"
#include "render/settings.h"
#include "settings/visit.h"

#include <cstdint>

namespace isophote::viewer {

/// How the viewer itself goes about it.
struct ViewSettings {
  float scale = 1;
  float draftMilliseconds = 250;
  bool refine = true;
  std::uint32_t refinePasses = 4096;

  void visit(auto&& v) {
    v("scale", scale,
      {.help = "Rendered pixels for each of the window's, along each side.", .min = 0.1, .max = 2});
    v("draftMilliseconds", draftMilliseconds,
      {.help = "While something moves, pictures that would take longer are made at a half, a third or a "
               "quarter of their size; 0: never.",
       .unit = "ms",
       .min = 0,
       .max = 60000});
    v("refine", refine, {.help = "Add passes to the picture while nothing moves, so that it converges."});
    v("refinePasses", refinePasses,
      {.help = "Passes after which a picture is done, where frame.passes does not say.",
       .min = 1,
       .max = 100'000'000});
  }
};

/// Everything that can be set in the viewer: its own settings, how the picture is shown, how it is rendered.
struct ViewerSettings {
  ViewSettings view;
  DisplayOptions display;
  RenderSettings render;

  void visitGroups(auto&& v) {
    v("view", view);
    v("display", display);
    render.visitGroups(v);
  }
};

}  // namespace isophote::viewer
