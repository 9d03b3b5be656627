// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "render/settings.h"

#include <span>
#include <string_view>

namespace isophote {

/// Settings that cannot work together.
struct Refusal {
  std::string_view setting;  ///< The one to change.
  std::string_view because;  ///< Why, and what would work.
  bool (*applies)(const RenderSettings&);
};

/// All of them, whatever the scene.
std::span<const Refusal> refusals();

/// Throws Error(kBadUsage) with the first that applies.
void refuseWhatCannotCombine(const RenderSettings& settings);

}  // namespace isophote
