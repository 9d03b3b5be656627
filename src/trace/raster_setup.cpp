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

SHARED_FN void projectVertices(const float* x, const float* y, const float* z, const Projector& p,
                               SetupLanes& s, int k) {
  float* __restrict toX = s.x[k];
  float* __restrict toY = s.y[k];
  float* __restrict toW = s.w[k];
  float* __restrict toZ = s.z[k];
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const RasterVertex v = project(p, x[i], y[i], z[i]);
    toX[i] = v.x;
    toY[i] = v.y;
    toW[i] = v.w;
    toZ[i] = v.z;
  }
}

/// The same sums in the same order as the product of matrix and vector.
SHARED_FN void moveVertices(const float* x, const float* y, const float* z, const mat4x3& m,
                            float* __restrict toX, float* __restrict toY, float* __restrict toZ) {
  const float m00 = m[0].x, m01 = m[0].y, m02 = m[0].z, m10 = m[1].x, m11 = m[1].y, m12 = m[1].z;
  const float m20 = m[2].x, m21 = m[2].y, m22 = m[2].z, m30 = m[3].x, m31 = m[3].y, m32 = m[3].z;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    toX[i] = m00 * x[i] + m10 * y[i] + m20 * z[i] + m30;
    toY[i] = m01 * x[i] + m11 * y[i] + m21 * z[i] + m31;
    toZ[i] = m02 * x[i] + m12 * y[i] + m22 * z[i] + m32;
  }
}

SHARED_FN void projectLanes(const RasterBlock& block, const Projector& p, const mat4x3* world,
                            SetupLanes& s) {
  alignas(64) float x[kLanes], y[kLanes], z[kLanes];
  for (int k = 0; k < 3; ++k)
    if (world) {
      moveVertices(block.x[k], block.y[k], block.z[k], *world, x, y, z);
      projectVertices(x, y, z, p, s, k);
    } else {
      projectVertices(block.x[k], block.y[k], block.z[k], p, s, k);
    }
}

/// First whole number from `low` on and last one up to `high`, within 0 to last; NaN asks for all. One choice
/// after the other: nested ones become branches.
SHARED_FN int firstWithin(float low, float end) {
  const float positive = low > 0.0f ? low : 0.0f;
  const float bounded = positive < end ? positive : end;
  const int whole = int(bounded);
  return whole + (float(whole) < bounded ? 1 : 0);
}
SHARED_FN int lastWithin(float high, float last) {
  const float bounded = high < last ? high : last;
  const float raised = bounded > -1.0f ? bounded : -1.0f;
  const int whole = int(raised);
  return whole - (float(whole) > raised ? 1 : 0);
}

/// Whether a triangle has all three vertices beyond one side of the picture, or none beyond the nearest
/// depth. Where vertices are on both sides of the eye, that says more than a box.
SHARED_FN void rejectLanes(const Projector& p, SetupLanes& s) {
  const float lastX = float(p.width - 1), lastY = float(p.height - 1);
  const float nearest = p.nearest;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const float x0 = s.x[0][i], x1 = s.x[1][i], x2 = s.x[2][i];
    const float y0 = s.y[0][i], y1 = s.y[1][i], y2 = s.y[2][i];
    const float w0 = s.w[0][i], w1 = s.w[1][i], w2 = s.w[2][i];
    const float tolerance = 0x1p-18f * greatest(abs(w0), abs(w1), abs(w2));
    const float right = least(x0 - lastX * w0, x1 - lastX * w1, x2 - lastX * w2) - lastX * tolerance;
    const float bottom = least(y0 - lastY * w0, y1 - lastY * w1, y2 - lastY * w2) - lastY * tolerance;
    const float beyond = greatest(right, bottom,
                                  -least(greatest(x0, x1, x2), greatest(y0, y1, y2),
                                         greatest(s.z[0][i], s.z[1][i], s.z[2][i]) - nearest));
    s.fate[i] = beyond > 0.0f ? kUnseen : kSmall;
  }
}

/// The box of pixels that each triangle may cover, for triangles in front of the eye with all vertices.
SHARED_FN void boundLanes(const float (*from)[kLanes], const float (*w)[kLanes], int last, float slack,
                          int* __restrict first, int* __restrict end) {
  const float lastPixel = float(last);
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const float a = from[0][i] / w[0][i], b = from[1][i] / w[1][i], c = from[2][i] / w[2][i];
    first[i] = firstWithin(least(a, b, c) - slack, lastPixel + 1.0f);
    end[i] = lastWithin(greatest(a, b, c) + slack, lastPixel);
  }
}

/// Those through the plane of the eye may cover any pixels, and those through the nearest depth want a test
/// that small ones go without.
SHARED_FN void decideFates(const Projector& p, SetupLanes& s) {
  const int lastColumn = p.width - 1, lastRow = p.height - 1;
  const float nearest = p.nearest;
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const int inFront = -int(least(s.w[0][i], s.w[1][i], s.w[2][i]) > 0.0f);
    const int left = s.x0[i] & inFront, top = s.y0[i] & inFront;
    const int right = (s.x1[i] & inFront) | (lastColumn & ~inFront);
    const int bottom = (s.y1[i] & inFront) | (lastRow & ~inFront);
    const int empty = -(int(left > right) | int(top > bottom));
    const int large = int(right - left >= kSmallSide) | int(bottom - top >= kSmallSide) | (inFront + 1) |
                      int(least(s.z[0][i], s.z[1][i], s.z[2][i]) <= nearest);
    s.x0[i] = left;
    s.y0[i] = top;
    s.x1[i] = right;
    s.y1[i] = bottom;
    // kUnseen, kSmall or kLarge.
    s.fate[i] = (s.fate[i] + (s.fate[i] & large)) & ~empty;
  }
}

SHARED_FN void keyLanes(const Projector& p, SetupLanes& s) {
  if (p.orthographic > 0.5f) {
    for (std::uint32_t i = 0; i < kLanes; ++i) {
      s.keyMin[i] = -greatest(s.z[0][i], s.z[1][i], s.z[2][i]);
      s.keyMax[i] = -least(s.z[0][i], s.z[1][i], s.z[2][i]);
    }
    return;
  }
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const float nearW = least(s.w[0][i], s.w[1][i], s.w[2][i]);
    const float key = 1.0f / nearW;
    s.keyMin[i] = 1.0f / greatest(s.w[0][i], s.w[1][i], s.w[2][i]);
    s.keyMax[i] = nearW > 0.0f ? key : kInfinity;
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

SHARED_FN bool anySeen(const SetupLanes& s) {
  int seen = 0;
  for (std::uint32_t i = 0; i < kLanes; ++i) seen |= s.fate[i];
  return seen != 0;
}

SHARED_FN void setUpBlockBody(const RasterBlock& block, const Projector& p, const mat4x3* world,
                              SetupLanes& s) {
  projectLanes(block, p, world, s);
  rejectLanes(p, s);
  if (!anySeen(s)) return;
  // More than the rounding of x / w.
  const float slack = float(std::max(p.width, p.height)) * 0x1p-20f;
  boundLanes(s.x, s.w, p.width - 1, slack, s.x0, s.x1);
  boundLanes(s.y, s.w, p.height - 1, slack, s.y0, s.y1);
  decideFates(p, s);
  if (!anySeen(s)) return;
  keyLanes(p, s);
  edgeLanes(p, s);
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
    const std::uint32_t entry = std::uint32_t(chunk_.small.size() - 1) | maskedEntry(t.flags);
    for (int row = t.y0 / kTileHeight; row <= t.y1 / kTileHeight; ++row)
      for (int column = t.x0 / kTileWidth; column <= t.x1 / kTileWidth; ++column)
        chunk_.placed.push_back({std::uint32_t(row * tilesX_ + column), entry});
  }

  void place(const LargeTriangle& t) {
    const std::uint32_t entry = std::uint32_t(chunk_.large.size() - 1) | kLargeEntry | maskedEntry(t.flags);
    const int first = t.x0 / kTileWidth, count = t.x1 / kTileWidth - first + 1;
    for (int row = t.y0 / kTileHeight; row <= t.y1 / kTileHeight; ++row) {
      touchRow_(t, first, count, row, touched_);
      for (int i = 0; i < count; ++i)
        if (touched_[i]) chunk_.placed.push_back({std::uint32_t(row * tilesX_ + first + i), entry});
    }
  }

 private:
  static std::uint32_t maskedEntry(std::uint32_t flags) { return flags & kMaskedTriangle ? kMaskedEntry : 0; }

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
