// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_bvh/packed_lanes.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

namespace isophote::photon_bvh {
namespace {

using Lanes = float (ViewTile::*)[kTileLanes];

constexpr Lanes kPlace[] = {&ViewTile::positionX, &ViewTile::positionY, &ViewTile::positionZ};
constexpr Lanes kNormals[] = {&ViewTile::ngX, &ViewTile::ngY, &ViewTile::ngZ,
                              &ViewTile::nsX, &ViewTile::nsY, &ViewTile::nsZ};
constexpr Lanes kGlossy[] = {
    &ViewTile::woX,      &ViewTile::woY,       &ViewTile::woZ,       &ViewTile::diffuseR, &ViewTile::diffuseG,
    &ViewTile::diffuseB, &ViewTile::f0R,       &ViewTile::f0G,       &ViewTile::f0B,      &ViewTile::f90,
    &ViewTile::alpha,    &ViewTile::coupling0, &ViewTile::coupling90};

}  // namespace

void PackedLanes::pack(const ViewTile& tile, std::uint64_t lanes) {
  sums_ = {};
  count_ = std::popcount(lanes);
  tile_ = &copy_;
  if (count_ == kTileLanes || tile.transmits != 0) {
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
  lanes_ = (count_ + photon_estimate::kGroupLanes - 1) / photon_estimate::kGroupLanes *
           photon_estimate::kGroupLanes;
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
  if (tile.lambertian == 0) copy(kGlossy, false, 0.0f);
}

void PackedLanes::addTo(RadianceTile& out) const {
  for (int i = 0; i < count_; ++i) {
    out.r[from_[i]] += sums_.r[i];
    out.g[from_[i]] += sums_.g[i];
    out.b[from_[i]] += sums_.b[i];
  }
}

}  // namespace isophote::photon_bvh
