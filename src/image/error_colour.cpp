// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "image/error_colour.h"

#include "image/lab.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace isophote {

namespace {

// A path through the L*a*b* space as a function of the error.
constexpr float kLightestL = 97.0f;
constexpr float kFirstHueDegrees = 295.0f;  ///< Violet.
constexpr float kHueTurnDegrees = 165.0f;   ///< Through red to yellow.
constexpr float kMostChroma = 80.0f;
constexpr int kSteps = 256;

bool isShowable(vec3 linear) {
  return std::min({linear.x, linear.y, linear.z}) >= 0.0f && std::max({linear.x, linear.y, linear.z}) <= 1.0f;
}

/// The colour of that lightness and hue, as vivid as a screen shows it up to `chroma`.
vec3 vividColour(float lightness, float hue, float chroma) {
  const auto withChroma = [&](float c) {
    return linearFromLab(vec3(lightness, c * std::cos(hue), c * std::sin(hue)));
  };
  if (isShowable(withChroma(chroma))) return withChroma(chroma);
  float shown = 0.0f, notShown = chroma;
  for (int i = 0; i < 20; ++i) {
    const float middle = 0.5f * (shown + notShown);
    (isShowable(withChroma(middle)) ? shown : notShown) = middle;
  }
  return clamp(withChroma(shown), 0.0f, 1.0f);
}

std::array<vec3, kSteps> makeTable() {
  std::array<vec3, kSteps> table{};
  for (int i = 0; i < kSteps; ++i) {
    const float t = float(i) / float(kSteps - 1);
    table[std::size_t(i)] = vividColour(kLightestL * t, glm::radians(kFirstHueDegrees + kHueTurnDegrees * t),
                                        kMostChroma * std::sin(kPi * t));
  }
  return table;
}

}  // namespace

vec3 errorColour(float error) {
  static const std::array<vec3, kSteps> kTable = makeTable();
  const float step = std::clamp(error, 0.0f, 1.0f) * float(kSteps - 1);
  return kTable[std::size_t(step + 0.5f)];
}

Image errorPicture(int width, int height, std::span<const float> errors) {
  Image picture(width, height);
  assert(errors.size() == picture.pixels.size());
  std::transform(errors.begin(), errors.end(), picture.pixels.begin(), errorColour);
  return picture;
}

}  // namespace isophote
