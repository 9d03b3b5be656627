// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/builtin/cloth.h"

#include <cmath>

namespace isophote {

namespace {

/// 0 below a, 1 above b, smooth between.
float ramp(float a, float b, float x) {
  const float t = clamp((x - a) / (b - a), 0.0f, 1.0f);
  return t * t * (3.0f - 2.0f * t);
}

}  // namespace

void addCurtain(Mesh& mesh, const Curtain& curtain) {
  constexpr int kColumns = 36, kRows = 12;
  constexpr float kTie = 0.58f;  // part of the height above the tie
  addPatch(mesh, {kColumns, kRows, false, false}, [&](int column, int row) {
    const float u = float(column) / kColumns, v = float(row) / kRows;
    // Gathered by the tie, half open again at the hem.
    const float gather = v < kTie ? 1.0f - 0.72f * ramp(0.05f, kTie, v) : 0.28f + 0.22f * ramp(kTie, 1.0f, v);
    const float depth = 0.040f * std::sqrt(gather);  // narrow folds are shallower
    const float angle = 2.0f * kPi * float(curtain.folds) * u + curtain.phase;
    const float swell = 0.06f * std::sin(kPi * v) * (1.0f - u);
    const float x = curtain.width * gather * (u + 0.006f * std::sin(2.0f * angle + 3.0f * v));
    // The free edge hangs lower where it is gathered.
    const float y = -curtain.height * (v + 0.05f * u * std::sin(kPi * v) * (1.0f - v));
    return vec3(x, y, swell + depth * std::sin(angle + 0.7f * std::sin(4.0f * v + curtain.phase)));
  });
}

void addBanner(Mesh& mesh, const Banner& banner) {
  constexpr int kColumns = 10, kRows = 14;
  addPatch(mesh, {kColumns, kRows, false, false}, [&](int column, int row) {
    const float u = 2.0f * float(column) / kColumns - 1.0f, v = float(row) / kRows;
    const float length = banner.height - 0.4f * banner.width * std::abs(u);
    const float wave = std::sin(5.0f * v + 1.6f * u + banner.phase) + 0.5f * std::sin(9.0f * v - 2.2f * u);
    const float narrow = 1.0f - 0.04f * v;
    return vec3(0.5f * banner.width * u * narrow, -v * length, 0.05f * v * wave + 0.03f * v);
  });
}

void addAwning(Mesh& mesh, const Awning& awning) {
  constexpr int kColumns = 32, kRows = 16;
  addPatch(mesh, {kColumns, kRows, false, false}, [&](int column, int row) {
    const float u = 2.0f * float(column) / kColumns - 1.0f, v = 2.0f * float(row) / kRows - 1.0f;
    const float middle = 1.0f - u * u;
    const float fold = 0.05f * middle * std::sin(4.0f * kPi * v + 2.0f * u + awning.phase);
    const float belly = 0.12f * middle * v * v;  // the edges stay a little higher
    const float narrow = 1.0f - 0.12f * middle;
    return vec3(0.5f * awning.length * u, -awning.sag * middle + belly + fold,
                -0.5f * awning.width * v * narrow);
  });
}

}  // namespace isophote
