// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/test_view.h"
#include "stages/view_clusters/cluster_tree.h"

#include <gtest/gtest.h>

#include <bit>
#include <map>

namespace isophote::view_clusters {
namespace {

using photon_volumes_test::makeView;

TEST(ViewClusters, EverySampleIsInOneCluster) {
  const ViewSamples view = makeView({.width = 300, .height = 150, .secondaryTiles = 20});
  Clusters clusters;
  for (const auto& [size, depth] : {std::pair(ClusterSize::k4x4, 0.25f), std::pair(ClusterSize::k8x4, 4.0f),
                                    std::pair(ClusterSize::k8x8, 4.0f), std::pair(ClusterSize::k16x8, 1.0f),
                                    std::pair(ClusterSize::k16x16, 0.25f)}) {
    clusters.build(view, size, depth, bestSimdLevel());
    std::map<std::uint32_t, std::uint64_t> lanes;
    for (std::size_t i = 0; i < clusters.all().size(); ++i) {
      if (i > 0) {
        EXPECT_GT(clusters.all()[i].key, clusters.all()[i - 1].key);
      }
      for (const Patch& patch : clusters.patchesOf(i)) {
        EXPECT_EQ(patch.key, clusters.all()[i].key);
        EXPECT_EQ(lanes[patch.tile] & patch.lanes, 0u);
        lanes[patch.tile] |= patch.lanes;
      }
    }
    for (std::uint32_t t = 0; t < view.tiles.size(); ++t)
      EXPECT_EQ(std::uint32_t(std::popcount(lanes[t])), view.tiles[t].count);
  }
}

TEST(ViewClusters, NodesHoldTheirChildren) {
  const ViewSamples view = makeView({.width = 640, .height = 480, .secondaryTiles = 90});
  Clusters clusters;
  clusters.build(view, ClusterSize::k8x8, 1.0f, bestSimdLevel());
  ClusterTree tree;
  tree.build(clusters, true, Alike::kFlatDiffuse);
  ASSERT_GE(tree.levels().size(), 3u);
  EXPECT_LE(tree.levels().back().size(), std::size_t(kNodeWidth));
  for (std::size_t l = 1; l < tree.levels().size(); ++l) {
    const Level& level = tree.levels()[l];
    const Level& below = tree.levels()[l - 1];
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < level.size(); ++i) {
      const Node& node = level.nodes[i];
      EXPECT_EQ(node.firstChild, next);
      next += node.childCount();
      std::uint32_t samples = 0;
      for (std::uint32_t c = node.firstChild; c < next; ++c) {
        const Node& child = below.nodes[c];
        samples += child.samples;
        EXPECT_EQ(child.parent, i);
        EXPECT_EQ(max(child.bounds.upper, node.bounds.upper), node.bounds.upper);
        EXPECT_EQ(min(child.bounds.lower, node.bounds.lower), node.bounds.lower);
      }
      EXPECT_EQ(node.samples, samples);
    }
    EXPECT_EQ(next, below.size());
  }
}

}  // namespace
}  // namespace isophote::view_clusters
