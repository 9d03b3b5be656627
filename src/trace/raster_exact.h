// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "trace/raster_setup.h"

#include <cmath>

namespace isophote::raster {

/// The exact sign of x1 y2 - y1 x2. Rounding is monotonic, so that products that round differently are in
/// that order; of equal ones the parts rounded away decide.
inline int signOfDifference(double x1, double y2, double y1, double x2) {
  const double p = x1 * y2, q = y1 * x2;
  if (p != q) return p > q ? 1 : -1;
  const double pRest = std::fma(x1, y2, -p), qRest = std::fma(y1, x2, -q);
  return pRest > qRest ? 1 : pRest < qRest ? -1 : 0;
}

/// On which side of the edge from a to b pixel (x, y) lies; 0 only where the edge has no direction. A pixel
/// on the edge counts as if it lay a little to the right of its place and even less below: one rule for all
/// triangles, which gives it to exactly one of those around it. Swapping a and b swaps the sign.
inline int sideOfEdge(const RasterVertex& a, const RasterVertex& b, int x, int y) {
  const double ax = double(a.x) - double(x) * double(a.w), ay = double(a.y) - double(y) * double(a.w);
  const double bx = double(b.x) - double(x) * double(b.w), by = double(b.y) - double(y) * double(b.w);
  if (const int side = signOfDifference(ax, by, ay, bx); side != 0) return side;
  if (const int right = signOfDifference(ay, double(b.w), double(a.w), by); right != 0) return right;
  return signOfDifference(double(a.w), bx, ax, double(b.w));
}

inline bool covers(const RasterVertex* v, bool negative, int x, int y) {
  const int inner = negative ? -1 : 1;
  return sideOfEdge(v[1], v[2], x, y) == inner && sideOfEdge(v[2], v[0], x, y) == inner &&
         sideOfEdge(v[0], v[1], x, y) == inner;
}

}  // namespace isophote::raster
