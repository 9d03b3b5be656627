// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "stages/gbuffer/view_samples.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote::gbuffer {

/// Packs samples into tiles along a Morton curve, so that the lanes of a tile lie close together.
class SecondaryTiles {
 public:
  /// Appends tiles of all the samples to `tiles`; reuses memory.
  void append(std::span<const std::vector<ViewSample>> samples, LargeVector<ViewTile>& tiles);

 private:
  struct Key {
    std::uint32_t morton;
    std::uint32_t order;
    const ViewSample* sample;
  };
  std::vector<Key> keys_;
};

}  // namespace isophote::gbuffer
