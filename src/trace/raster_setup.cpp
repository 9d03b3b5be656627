// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster_setup.h"

#include <algorithm>
#include <limits>

namespace isophote::raster {

namespace {

constexpr std::uint32_t kLanes = kRasterLanes;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

enum Fate : int { kUnseen = 0, kSmall = 1, kLarge = 2 };

/// A block on its way to the picture, one lane a triangle.
struct alignas(64) SetupLanes {
  float x[3][kLanes], y[3][kLanes], w[3][kLanes], z[3][kLanes];
  int fate[kLanes];
  int x0[kLanes], y0[kLanes], x1[kLanes], y1[kLanes];
  float keyMin[kLanes], keyMax[kLanes];
  int negative[kLanes];
  double a[3][kLanes], b[3][kLanes], c[3][kLanes];
  double keyA[kLanes], keyB[kLanes], keyC[kLanes];
};

SHARED_FN float least(float a, float b, float c) {
  const float ab = a < b ? a : b;
  return ab < c ? ab : c;
}
SHARED_FN float greatest(float a, float b, float c) {
  const float ab = a > b ? a : b;
  return ab > c ? ab : c;
}
SHARED_FN double greatest(double a, double b, double c) {
  const double ab = a > b ? a : b;
  return ab > c ? ab : c;
}

SHARED_FN void projectLanes(const RasterBlock& block, const Projector& p, const mat4x3* world,
                            SetupLanes& s) {
  for (int k = 0; k < 3; ++k)
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      vec3 position(block.x[k][i], block.y[k][i], block.z[k][i]);
      if (world) position = *world * vec4(position, 1.0f);
      const RasterVertex v = project(p, position);
      s.x[k][i] = v.x;
      s.y[k][i] = v.y;
      s.w[k][i] = v.w;
      s.z[k][i] = v.z;
    }
}

/// First whole number from `low` on and last one up to `high`, within 0 to last; NaN asks for all.
SHARED_FN int firstWithin(float low, int last) {
  const float bounded = low > 0.0f ? (low < float(last + 1) ? low : float(last + 1)) : 0.0f;
  const int whole = int(bounded);
  return whole + (float(whole) < bounded ? 1 : 0);
}
SHARED_FN int lastWithin(float high, int last) {
  const float bounded = high < float(last) ? (high > -1.0f ? high : -1.0f) : float(last);
  const int whole = int(bounded);
  return whole - (float(whole) > bounded ? 1 : 0);
}

/// The box of pixels that each triangle may cover, and its fate as far as that decides.
SHARED_FN void boundLanes(const Projector& p, SetupLanes& s) {
  const int lastX = p.width - 1, lastY = p.height - 1;
  const float endX = float(lastX), endY = float(lastY);
  // More than the rounding of x / w.
  const float slack = float(std::max(p.width, p.height)) * 0x1p-20f;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const float x0 = s.x[0][i], x1 = s.x[1][i], x2 = s.x[2][i];
    const float y0 = s.y[0][i], y1 = s.y[1][i], y2 = s.y[2][i];
    const float w0 = s.w[0][i], w1 = s.w[1][i], w2 = s.w[2][i];
    const float z0 = s.z[0][i], z1 = s.z[1][i], z2 = s.z[2][i];
    const float r0 = 1.0f / w0, r1 = 1.0f / w1, r2 = 1.0f / w2;
    const int inFront = least(w0, w1, w2) > 0.0f ? 1 : 0;
    const int near = least(z0, z1, z2) > p.nearest ? 0 : 1;
    // Beyond one side of the picture with all three vertices; where they are on both sides of the eye, that
    // says more than a box.
    const float tolerance = 0x1p-18f * endX * greatest(abs(w0), abs(w1), abs(w2));
    const float toleranceY = 0x1p-18f * endY * greatest(abs(w0), abs(w1), abs(w2));
    const int beyond = (greatest(x0, x1, x2) < 0.0f ? 1 : 0) | (greatest(y0, y1, y2) < 0.0f ? 1 : 0) |
                       (least(x0 - endX * w0, x1 - endX * w1, x2 - endX * w2) > tolerance ? 1 : 0) |
                       (least(y0 - endY * w0, y1 - endY * w1, y2 - endY * w2) > toleranceY ? 1 : 0) |
                       (greatest(z0, z1, z2) > p.nearest ? 0 : 1);
    const float low = least(x0 * r0, x1 * r1, x2 * r2) - slack;
    const float high = greatest(x0 * r0, x1 * r1, x2 * r2) + slack;
    const float lowY = least(y0 * r0, y1 * r1, y2 * r2) - slack;
    const float highY = greatest(y0 * r0, y1 * r1, y2 * r2) + slack;
    const int left = inFront ? firstWithin(low, lastX) : 0;
    const int right = inFront ? lastWithin(high, lastX) : lastX;
    const int top = inFront ? firstWithin(lowY, lastY) : 0;
    const int bottom = inFront ? lastWithin(highY, lastY) : lastY;
    const int empty = (left > right ? 1 : 0) | (top > bottom ? 1 : 0) | beyond;
    const int large =
        near | (right - left >= kSmallSide ? 1 : 0) | (bottom - top >= kSmallSide ? 1 : 0) | (1 - inFront);
    s.x0[i] = left;
    s.y0[i] = top;
    s.x1[i] = right;
    s.y1[i] = bottom;
    s.fate[i] = empty ? kUnseen : large ? kLarge : kSmall;
    const bool parallel = p.orthographic > 0.5f;
    const float farW = 1.0f / greatest(w0, w1, w2), nearW = 1.0f / least(w0, w1, w2);
    s.keyMin[i] = parallel ? -greatest(z0, z1, z2) : farW;
    s.keyMax[i] = parallel ? -least(z0, z1, z2) : inFront ? nearW : kInfinity;
  }
}

/// Edge functions relative to (x0, y0), scaled as raster_setup.h says, and keys.
SHARED_FN void edgeLanes(const Projector& p, SetupLanes& s) {
  const double width = p.width, height = p.height;
  const bool parallel = p.orthographic > 0.5f;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const double px = s.x0[i], py = s.y0[i];
    const double w0 = double(s.w[0][i]), w1 = double(s.w[1][i]), w2 = double(s.w[2][i]);
    const double x0 = double(s.x[0][i]) - px * w0, y0 = double(s.y[0][i]) - py * w0;
    const double x1 = double(s.x[1][i]) - px * w1, y1 = double(s.y[1][i]) - py * w1;
    const double x2 = double(s.x[2][i]) - px * w2, y2 = double(s.y[2][i]) - py * w2;
    double a[3] = {y1 * w2 - w1 * y2, y2 * w0 - w2 * y0, y0 * w1 - w0 * y1};
    double b[3] = {w1 * x2 - x1 * w2, w2 * x0 - x2 * w0, w0 * x1 - x0 * w1};
    double c[3] = {x1 * y2 - y1 * x2, x2 * y0 - y2 * x0, x0 * y1 - y0 * x1};
    const double determinant = a[0] * x0 + b[0] * y0 + c[0] * w0;
    const int negative = determinant < 0.0 ? 1 : 0;
    const double inner = negative ? -1.0 : 1.0;
    s.negative[i] = negative;
    s.fate[i] = determinant != 0.0 ? s.fate[i] : int(kUnseen);

    // A pixel's weights of the vertices, times 1 / w, are the edge functions over the determinant.
    const double inverse = 1.0 / determinant;
    const double q0 = (parallel ? -double(s.z[0][i]) : 1.0) * inverse;
    const double q1 = (parallel ? -double(s.z[1][i]) : 1.0) * inverse;
    const double q2 = (parallel ? -double(s.z[2][i]) : 1.0) * inverse;
    s.keyA[i] = a[0] * q0 + a[1] * q1 + a[2] * q2;
    s.keyB[i] = b[0] * q0 + b[1] * q1 + b[2] * q2;
    s.keyC[i] = c[0] * q0 + c[1] * q1 + c[2] * q2;

    // The doubles' rounding, in terms of the largest numbers that went in, and the floats' within a box of
    // pixels: where an edge function is near 0, c is no larger than what a and b make of the box.
    const double mw = greatest(std::abs(w0), std::abs(w1), std::abs(w2));
    const double mx = greatest(std::abs(x0), std::abs(x1), std::abs(x2)) + width * mw;
    const double my = greatest(std::abs(y0), std::abs(y1), std::abs(y2)) + height * mw;
    const double ofDoubles = 0x1p-47 * 3.0 * mx * my;
    const double boxX = s.fate[i] == kLarge ? kTileWidth : kSmallSide;
    const double boxY = s.fate[i] == kLarge ? kTileHeight : kSmallSide;
    for (int k = 0; k < 3; ++k) {
      const double error = 0x1p-20 * (std::abs(a[k]) * boxX + std::abs(b[k]) * boxY) + ofDoubles;
      const double scale = inner / error;
      s.a[k][i] = a[k] * scale;
      s.b[k][i] = b[k] * scale;
      s.c[k][i] = c[k] * scale;
    }
  }
}

SHARED_FN void setUpBlockBody(const RasterBlock& block, const Projector& p, const mat4x3* world,
                              SetupLanes& s) {
  projectLanes(block, p, world, s);
  boundLanes(p, s);
  int seen = 0;
  for (std::uint32_t i = 0; i < kLanes; ++i) seen |= s.fate[i];
  if (seen) edgeLanes(p, s);
}
ISOPHOTE_SIMD(setUpBlock, setUpBlockBody,
              (const RasterBlock& block, const Projector& p, const mat4x3* world, SetupLanes& s),
              (block, p, world, s))

/// touched[i]: whether the triangle may cover pixels of tile (first + i, row).
SHARED_FN void touchRowBody(const LargeTriangle& t, int first, int count, int row, int* touched) {
  for (int i = 0; i < count; ++i) touched[i] = 1;
  const double y = double(row * kTileHeight) - double(t.y0);
  for (int k = 0; k < 3; ++k) {
    const double a = t.a[k], b = t.b[k];
    const double most = t.c[k] + b * y + (a > 0.0 ? a * (kTileWidth - 1) : 0.0) +
                        (b > 0.0 ? b * (kTileHeight - 1) : 0.0) + 1.0;
    for (int i = 0; i < count; ++i)
      touched[i] &= most + a * (double((first + i) * kTileWidth) - double(t.x0)) >= 0.0 ? 1 : 0;
  }
}
ISOPHOTE_SIMD(touchRow, touchRowBody, (const LargeTriangle& t, int first, int count, int row, int* touched),
              (t, first, count, row, touched))

template <class Triangle, class Number>
void fill(const SetupLanes& s, std::uint32_t i, std::uint32_t id, std::uint32_t flags, Triangle& t) {
  for (int k = 0; k < 3; ++k) {
    t.a[k] = Number(s.a[k][i]);
    t.b[k] = Number(s.b[k][i]);
    t.c[k] = Number(s.c[k][i]);
  }
  t.keyA = Number(s.keyA[i]);
  t.keyB = Number(s.keyB[i]);
  t.keyC = Number(s.keyC[i]);
  t.keyMin = s.keyMin[i];
  t.keyMax = s.keyMax[i];
  t.x0 = std::uint16_t(s.x0[i]);
  t.y0 = std::uint16_t(s.y0[i]);
  t.x1 = std::uint16_t(s.x1[i]);
  t.y1 = std::uint16_t(s.y1[i]);
  t.id = id;
  t.flags = flags | (s.negative[i] ? kNegativeTriangle : 0);
}

/// Places the triangles of a block into the tiles that they may cover.
class Placer {
 public:
  Placer(const Projector& p, SimdLevel level, Chunk& chunk)
      : tilesX_((p.width + kTileWidth - 1) / kTileWidth), touchRow_(touchRowFor(level)), chunk_(chunk) {}

  void place(const SmallTriangle& t) {
    const auto entry = std::uint32_t(chunk_.small.size() - 1);
    for (int row = t.y0 / kTileHeight; row <= t.y1 / kTileHeight; ++row)
      for (int column = t.x0 / kTileWidth; column <= t.x1 / kTileWidth; ++column)
        chunk_.placed.push_back({std::uint32_t(row * tilesX_ + column), entry});
  }

  void place(const LargeTriangle& t) {
    const std::uint32_t entry = std::uint32_t(chunk_.large.size() - 1) | kLargeEntry;
    const int first = t.x0 / kTileWidth, count = t.x1 / kTileWidth - first + 1;
    for (int row = t.y0 / kTileHeight; row <= t.y1 / kTileHeight; ++row) {
      touchRow_(t, first, count, row, touched_);
      for (int i = 0; i < count; ++i)
        if (touched_[i]) chunk_.placed.push_back({std::uint32_t(row * tilesX_ + first + i), entry});
    }
  }

 private:
  int tilesX_;
  decltype(touchRowFor(SimdLevel::kBaseline)) touchRow_;
  Chunk& chunk_;
  alignas(64) int touched_[32768 / kTileWidth];
};

void sortByTile(std::uint32_t tiles, Chunk& chunk) {
  chunk.tileBegins.assign(tiles + 2, 0);
  for (const Chunk::Placed& placed : chunk.placed) ++chunk.tileBegins[placed.tile + 2];
  for (std::uint32_t i = 2; i < tiles + 2; ++i) chunk.tileBegins[i] += chunk.tileBegins[i - 1];
  chunk.entries.resize(chunk.placed.size());
  // Counts up to where each tile's entries end, which is where the next one's begin.
  for (const Chunk::Placed& placed : chunk.placed)
    chunk.entries[chunk.tileBegins[placed.tile + 1]++] = placed.entry;
}

}  // namespace

void setUp(const RasterScene& scene, const Projector& projector, std::span<const BlockUse> blocks,
           SimdLevel level, Chunk& chunk) {
  chunk.small.clear();
  chunk.large.clear();
  chunk.placed.clear();
  const auto setUpBlock = setUpBlockFor(level);
  Placer placer(projector, level, chunk);
  SetupLanes lanes;
  for (const BlockUse& use : blocks) {
    const RasterBlock& block = scene.blocks()[use.block];
    const RasterInstance& instance = scene.instances()[use.instance];
    const ShadedInstance& shaded = scene.trace().instance(use.instance);
    setUpBlock(block, projector, shaded.inWorldSpace ? nullptr : &shaded.worldFromObject, lanes);
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      if (lanes.fate[i] == kUnseen || block.triangle[i] == kNoTriangle) continue;
      const std::uint32_t id = instance.firstTriangle + block.triangle[i];
      const std::uint32_t flags = instance.masked ? kMaskedTriangle : 0;
      if (lanes.fate[i] == kSmall) {
        fill<SmallTriangle, float>(lanes, i, id, flags, chunk.small.emplace_back());
        placer.place(chunk.small.back());
      } else {
        fill<LargeTriangle, double>(lanes, i, id, flags, chunk.large.emplace_back());
        placer.place(chunk.large.back());
      }
    }
  }
  const int tilesX = (projector.width + kTileWidth - 1) / kTileWidth;
  const int tilesY = (projector.height + kTileHeight - 1) / kTileHeight;
  sortByTile(std::uint32_t(tilesX * tilesY), chunk);
}

}  // namespace isophote::raster
