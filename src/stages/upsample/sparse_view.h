// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/keyed_sort.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/upsample/upsample_body.h"

#include <cstdint>
#include <span>
#include <vector>

namespace isophote::upsample {

/// A lane of a view's tile.
struct Place {
  std::size_t tile;
  int lane;
};

/// The view samples at which light is estimated: one a cell; for those that reflect glossily that reflection
/// alone, too; pixels on their own; all that is seen in mirrors and through glass. In this order, the first
/// as primary tiles of a picture of one pixel a cell. Keeps its memory.
class SparseView {
 public:
  /// Begins anew with the cells of side x side pixels.
  void chooseCells(const ViewSamples& view, std::uint32_t side, std::uint32_t pass, uint weights);
  /// Then, the lanes of each primary tile whose bits are set, and the secondary tiles.
  void addSingle(const ViewSamples& view, std::span<const std::uint64_t> lanes);

  const ViewSamples& view() const { return view_; }
  const Cells& cells() const { return grid_; }

  /// Puts the light that was estimated at view() into the cells.
  void takeLight(const Radiance& light);
  /// Index of the first of the lanes of a primary tile that addSingle() got.
  std::size_t firstSingle(std::size_t tile) const { return singleBegin_[tile]; }
  std::size_t singles() const { return singleBegin_.empty() ? 0 : singleBegin_.back(); }
  vec3 singleLight(const Radiance& light, std::size_t single) const;

 private:
  void chooseTile(const ViewSamples& view, std::size_t tile);
  void addGlossyTiles();
  void orderSingles(const ViewSamples& view, std::span<const std::uint64_t> lanes);

  ViewSamples view_;
  Cells grid_{};
  LargeVector<Cell> cells_;
  LargeVector<ViewTile> glossy_;            ///< Of each primary tile of view_; its count is 0 where there is
                                            ///< none.
  std::vector<std::uint32_t> glossyTile_;   ///< Where each went in view_.tiles, kNoTile if nowhere.
  std::vector<std::uint32_t> singleBegin_;  ///< Of each primary tile's lanes, and the end.
  std::vector<Place> singles_;              ///< Where each comes from.
  LargeVector<KeyedIndex> order_;           ///< The singles as they lie in view_.tiles.
  std::vector<std::uint32_t> places_;       ///< Of each single among them.
  KeyedSort sort_;
  std::size_t firstSingleTile_ = 0;  ///< In view_.tiles.

  static constexpr std::uint32_t kNoTile = 0xffffffffu;
};

}  // namespace isophote::upsample
