// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/session.h"

#include <string>
#include <vector>

namespace isophote::viewer {

/// What the panel says besides the session itself.
struct PanelFacts {
  const RenderedPicture& picture;
  double picturesPerSecond = 0;
  std::string error{};
  std::vector<std::string> warnings{};
  std::string notice{};  ///< What has been done last, such as a picture kept.
};

/// Width of the panel beside the picture [pixels of the framebuffer]; `pixelScale` as Window's.
int panelWidth(float pixelScale);

/// Draws all that is not the picture, whose size is the session's: the panel on its right, the lights'
/// markers and the key table. True while a widget is being dragged. To be called between Window::beginFrame()
/// and endFrame().
bool drawPanels(Session& session, const PanelFacts& facts, float pixelScale);

/// Whether the panels want the pointer or the keys for themselves.
bool panelsWantPointer();
bool panelsWantKeys();

}  // namespace isophote::viewer
