// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/view_samples.h"

#include <algorithm>

namespace isophote {

void clearTile(ViewTile& tile) {
  // Zero is right for every array but these.
  tile = ViewTile{};
  std::fill_n(tile.positionX, kTileLanes, kFarAway);
  std::fill_n(tile.positionY, kTileLanes, kFarAway);
  std::fill_n(tile.positionZ, kTileLanes, kFarAway);
  std::fill_n(tile.ngZ, kTileLanes, 1.0f);
  std::fill_n(tile.nsZ, kTileLanes, 1.0f);
  std::fill_n(tile.woZ, kTileLanes, 1.0f);
  std::fill_n(tile.pixel, kTileLanes, kNoPixel);
  tile.lambertian = 1;
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
  tile.f0R[lane] = s.bsdf.f0.x;
  tile.f0G[lane] = s.bsdf.f0.y;
  tile.f0B[lane] = s.bsdf.f0.z;
  tile.f90[lane] = s.bsdf.f90;
  tile.alpha[lane] = s.bsdf.alpha;
  tile.coupling0[lane] = s.bsdf.coupling0;
  tile.coupling90[lane] = s.bsdf.coupling90;
  tile.throughputR[lane] = s.throughput.x;
  tile.throughputG[lane] = s.throughput.y;
  tile.throughputB[lane] = s.throughput.z;
  tile.pixel[lane] = s.pixel;
  tile.bounds.extend(s.position);
  ++tile.count;
  const bool reflects = s.bsdf.alpha > 0.0f && s.bsdf.f90 > 0.0f;
  if (reflects || s.bsdf.coupling90 > 0.0f) tile.lambertian = 0;
}

ViewSample laneOf(const ViewTile& tile, int lane) {
  ViewSample s;
  s.position = vec3(tile.positionX[lane], tile.positionY[lane], tile.positionZ[lane]);
  s.ng = vec3(tile.ngX[lane], tile.ngY[lane], tile.ngZ[lane]);
  s.ns = vec3(tile.nsX[lane], tile.nsY[lane], tile.nsZ[lane]);
  s.wo = vec3(tile.woX[lane], tile.woY[lane], tile.woZ[lane]);
  s.bsdf = Bsdf{};
  s.bsdf.diffuse = vec3(tile.diffuseR[lane], tile.diffuseG[lane], tile.diffuseB[lane]);
  s.bsdf.f0 = vec3(tile.f0R[lane], tile.f0G[lane], tile.f0B[lane]);
  s.bsdf.f90 = tile.f90[lane];
  s.bsdf.alpha = tile.alpha[lane];
  s.bsdf.coupling0 = tile.coupling0[lane];
  s.bsdf.coupling90 = tile.coupling90[lane];
  s.bsdf.ior = 1.0f;
  s.throughput = vec3(tile.throughputR[lane], tile.throughputG[lane], tile.throughputB[lane]);
  s.pixel = tile.pixel[lane];
  return s;
}

}  // namespace isophote
