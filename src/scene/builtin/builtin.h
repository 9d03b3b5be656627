// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

#include <functional>
#include <span>
#include <string_view>

namespace isophote {

struct BuiltinScene {
  std::string_view name;
  std::string_view description;  ///< One sentence.
  Scene (*make)();               ///< Unfinished: finishScene() is the caller's.
};

/// All built-in scenes, in the order in which they are listed to people.
std::span<const BuiltinScene> builtinScenes();
/// Null when there is none of that name.
const BuiltinScene* findBuiltinScene(std::string_view name);

}  // namespace isophote
