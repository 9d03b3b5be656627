// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/packed_samples.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

namespace isophote::photon_estimate {
namespace {

using Lanes = float (ViewTile::*)[kTileLanes];

constexpr Lanes kPlace[] = {&ViewTile::positionX, &ViewTile::positionY, &ViewTile::positionZ};
constexpr Lanes kNormals[] = {&ViewTile::ngX, &ViewTile::ngY, &ViewTile::ngZ};
constexpr Lanes kShadingNormals[] = {&ViewTile::nsX, &ViewTile::nsY, &ViewTile::nsZ};
constexpr Lanes kGlossy[] = {
    &ViewTile::woX,      &ViewTile::woY,       &ViewTile::woZ,       &ViewTile::diffuseR, &ViewTile::diffuseG,
    &ViewTile::diffuseB, &ViewTile::f0R,       &ViewTile::f0G,       &ViewTile::f0B,      &ViewTile::f90,
    &ViewTile::alpha,    &ViewTile::coupling0, &ViewTile::coupling90};

}  // namespace

void PackedSamples::pack(const ViewTile& tile, std::uint64_t lanes, SphereLoopKind kind, vec3 power) {
  original_ = &tile;
  lambertian_ = kind.lambertian;
  count_ = std::popcount(lanes);
  std::fill_n(sums_.r, kTileLanes, power.x);
  std::fill_n(sums_.g, kTileLanes, power.y);
  std::fill_n(sums_.b, kTileLanes, power.z);
  tile_ = &copy_;
  if (count_ == kTileLanes || kind.transmits) {
    // What light goes through is not looped over by groups: all other lanes are taken out
    // instead.
    lanes_ = count_ = kTileLanes;
    std::iota(from_, from_ + kTileLanes, std::uint8_t(0));
    if (lanes == ~std::uint64_t(0)) {
      tile_ = &tile;
      return;
    }
    copy_ = tile;
    for (int lane = 0; lane < kTileLanes; ++lane)
      if ((lanes >> lane & 1u) == 0) copy_.pixel[lane] = kNoPixel;
    return;
  }
  lanes_ = (count_ + kGroupLanes - 1) / kGroupLanes * kGroupLanes;
  int next = 0;
  for (std::uint64_t left = lanes; left != 0; left &= left - 1)
    from_[next++] = std::uint8_t(std::countr_zero(left));
  const auto copy = [&](std::span<const Lanes> arrays, bool fills, float fill) {
    for (const Lanes array : arrays) {
      for (int i = 0; i < count_; ++i) (copy_.*array)[i] = (tile.*array)[from_[i]];
      std::fill((copy_.*array) + count_, (copy_.*array) + lanes_, fills ? fill : (copy_.*array)[0]);
    }
  };
  copy(kPlace, true, kFarAway);
  copy(kNormals, true, 0.0f);
  if (!kind.lambertian || !kind.flat) copy(kShadingNormals, true, 0.0f);
  if (!kind.lambertian) copy(kGlossy, false, 0.0f);
}

void PackedSamples::addTo(RadianceTile& out) const {
  for (int i = 0; i < count_; ++i) {
    out.r[from_[i]] += sums_.r[i];
    out.g[from_[i]] += sums_.g[i];
    out.b[from_[i]] += sums_.b[i];
  }
}

void PackedSamples::addRadianceTo(RadianceTile& out) const {
  if (!lambertian_) return addTo(out);
  for (int i = 0; i < count_; ++i) {
    const int lane = from_[i];
    const vec3 radiance = vec3(sums_.r[i], sums_.g[i], sums_.b[i]) * diffuseOf(*original_, lane) * kInvPi;
    out.r[lane] += radiance.x;
    out.g[lane] += radiance.y;
    out.b[lane] += radiance.z;
  }
}

}  // namespace isophote::photon_estimate
