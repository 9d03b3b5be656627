// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/view_samples.h"

#include <algorithm>

namespace isophote {

namespace {

void fill(float value, std::initializer_list<float*> arrays) {
  for (float* array : arrays) std::fill_n(array, kTileLanes, value);
}

}  // namespace

void clearTile(ViewTile& t) {
  fill(kFarAway, {t.positionX, t.positionY, t.positionZ});
  fill(0.0f, {t.ngX, t.ngY, t.nsX, t.nsY, t.woX, t.woY, t.diffuseR, t.diffuseG, t.diffuseB});
  fill(1.0f, {t.ngZ, t.nsZ, t.woZ});
  std::fill_n(t.pixel, kTileLanes, kNoPixel);
  t.bounds = {};
  t.count = 0;
  t.lambertian = 1;
  t.transmits = 0;
  t.unitThroughput = 1;
}

void startGlossy(ViewTile& t) {
  if (t.lambertian == 0) return;
  fill(0.0f, {t.f0R, t.f0G, t.f0B, t.f90, t.alpha, t.coupling0, t.coupling90});
  t.lambertian = 0;
}

void startTransmission(ViewTile& t) {
  startGlossy(t);
  if (t.transmits != 0) return;
  fill(0.0f, {t.transmissionR, t.transmissionG, t.transmissionB, t.through});
  fill(1.0f, {t.ior});
  std::fill_n(t.sides, kTileLanes, kSideOutside);
  t.transmits = 1;
}

void startThroughput(ViewTile& t) {
  if (t.unitThroughput == 0) return;
  fill(1.0f, {t.throughputR, t.throughputG, t.throughputB});
  t.unitThroughput = 0;
}

void setLane(ViewTile& tile, int lane, const ViewSample& s) {
  tile.positionX[lane] = s.position.x;
  tile.positionY[lane] = s.position.y;
  tile.positionZ[lane] = s.position.z;
  tile.ngX[lane] = s.ng.x;
  tile.ngY[lane] = s.ng.y;
  tile.ngZ[lane] = s.ng.z;
  tile.nsX[lane] = s.ns.x;
  tile.nsY[lane] = s.ns.y;
  tile.nsZ[lane] = s.ns.z;
  tile.woX[lane] = s.wo.x;
  tile.woY[lane] = s.wo.y;
  tile.woZ[lane] = s.wo.z;
  tile.diffuseR[lane] = s.bsdf.diffuse.x;
  tile.diffuseG[lane] = s.bsdf.diffuse.y;
  tile.diffuseB[lane] = s.bsdf.diffuse.z;
  tile.pixel[lane] = s.pixel;
  tile.bounds.extend(s.position);
  ++tile.count;
  if (!isLambertian(s.bsdf)) startGlossy(tile);
  if (tile.lambertian == 0) {
    tile.f0R[lane] = s.bsdf.f0.x;
    tile.f0G[lane] = s.bsdf.f0.y;
    tile.f0B[lane] = s.bsdf.f0.z;
    tile.f90[lane] = s.bsdf.f90;
    tile.alpha[lane] = s.bsdf.alpha;
    tile.coupling0[lane] = s.bsdf.coupling0;
    tile.coupling90[lane] = s.bsdf.coupling90;
  }
  if (refractsRoughly(s.bsdf) > 0.5f) {
    startTransmission(tile);
    tile.transmissionR[lane] = s.bsdf.transmission.x;
    tile.transmissionG[lane] = s.bsdf.transmission.y;
    tile.transmissionB[lane] = s.bsdf.transmission.z;
    tile.through[lane] = s.bsdf.through;
    tile.ior[lane] = s.bsdf.ior;
    tile.sides[lane] = (s.entering > 0.5f ? kSideOutside : 0u) |
                       ((s.bsdf.flags & kMaterialThinWalled) != 0u ? kSideThin : 0u);
  }
  if (s.throughput != vec3(1.0f)) startThroughput(tile);
  if (tile.unitThroughput == 0) {
    tile.throughputR[lane] = s.throughput.x;
    tile.throughputG[lane] = s.throughput.y;
    tile.throughputB[lane] = s.throughput.z;
  }
}

ViewSample laneOf(const ViewTile& tile, int lane) {
  ViewSample s;
  s.position = positionOf(tile, lane);
  s.ng = ngOf(tile, lane);
  s.ns = nsOf(tile, lane);
  s.wo = woOf(tile, lane);
  if (tile.lambertian == 0) {
    s.bsdf = reflectionOf(tile, lane);
  } else {
    s.bsdf = Bsdf{};
    s.bsdf.diffuse = diffuseOf(tile, lane);
  }
  s.bsdf.ior = 1.0f;
  s.entering = 1.0f;
  if (tile.transmits != 0) {
    s.bsdf.transmission = vec3(tile.transmissionR[lane], tile.transmissionG[lane], tile.transmissionB[lane]);
    s.bsdf.through = tile.through[lane];
    s.bsdf.ior = tile.ior[lane];
    s.bsdf.flags = (tile.sides[lane] & kSideThin) != 0u ? kMaterialThinWalled : 0u;
    s.entering = (tile.sides[lane] & kSideOutside) != 0u ? 1.0f : 0.0f;
  }
  s.throughput = throughputOf(tile, lane);
  s.pixel = tile.pixel[lane];
  return s;
}

}  // namespace isophote
