// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/gbuffer/secondary_tiles.h"

#include "math/morton.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

namespace isophote::gbuffer {

void SecondaryTiles::append(std::span<const std::vector<ViewSample>> samples, LargeVector<ViewTile>& tiles) {
  Bounds bounds;
  keys_.clear();
  for (const std::vector<ViewSample>& some : samples)
    for (const ViewSample& s : some) {
      bounds.extend(s.position);
      keys_.push_back({0, std::uint32_t(keys_.size()), &s});
    }
  const vec3 scale = vec3(1023.0f) / max(bounds.size(), vec3(1e-20f));
  for (Key& key : keys_) key.morton = mortonCode((key.sample->position - bounds.lower) * scale, 10);
  tbb::parallel_sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) {
    return a.morton != b.morton ? a.morton < b.morton : a.order < b.order;
  });
  const std::size_t first = tiles.size();
  tiles.resize(first + (keys_.size() + kTileLanes - 1) / kTileLanes);
  tbb::parallel_for(first, tiles.size(), [&](std::size_t t) {
    clearTile(tiles[t]);
    const std::size_t begin = (t - first) * kTileLanes;
    for (std::size_t lane = 0; lane < kTileLanes && begin + lane < keys_.size(); ++lane)
      setLane(tiles[t], int(lane), *keys_[begin + lane].sample);
  });
}

}  // namespace isophote::gbuffer
