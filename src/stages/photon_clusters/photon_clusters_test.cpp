// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/photon_clusters.h"

#include "stages/photon_clusters/cluster_tree.h"
#include "support/sphere_tests.h"

#include <bit>
#include <map>

namespace isophote {
namespace {

using namespace sphere_tests;
using namespace photon_clusters;

PhotonClusters with(bool cone, TrivialAccept trivial, float cellDepth = 4) {
  PhotonClustersSettings settings;
  settings.cone = cone;
  settings.trivial = trivial;
  settings.cellDepth = cellDepth;
  return PhotonClusters(settings);
}
PhotonClusters plain() { return with(false, TrivialAccept::kOff); }
PhotonClusters both() { return with(true, TrivialAccept::kFlat); }

TEST(PhotonClusters, MatchesVolumesWhereverTheEyeIs) {
  expectMatchesVolumesWhereverTheEyeIs(plain, "photon_clusters.pairsContributing");
  expectMatchesVolumesWhereverTheEyeIs([] { return with(true, TrivialAccept::kOff); },
                                       "photon_clusters.pairsContributing");
}
TEST(PhotonClusters, TheSameBytesWithAnyNumberOfThreads) {
  expectSameBytesWithAnyNumberOfThreads(plain);
  expectSameBytesWithAnyNumberOfThreads(both);
}
TEST(PhotonClusters, EveryInstructionSetGivesTheSameBytes) {
  expectSameBytesOfEveryInstructionSet(plain);
  expectSameBytesOfEveryInstructionSet(both);
}
TEST(PhotonClusters, ASmallMemoryBudgetGivesTheSamePicture) {
  expectSamePictureWithinASmallMemoryBudget(plain, "photon_clusters.subPasses");
  expectSamePictureWithinASmallMemoryBudget(both, "photon_clusters.subPasses");
}
TEST(PhotonClusters, ASecondRunOverwritesTheFirst) { expectASecondRunOverwritesTheFirst(both); }
TEST(PhotonClusters, StopsAndRefusesARadiusOfZero) { expectStopsAndRefusesARadiusOfZero(both); }

TEST(PhotonClusters, TheDepthOfTheCellsChangesNoPicture) {
  const ViewSamples view = makeView({.secondaryTiles = 9});
  const PhotonMap map = makePhotons(3000);
  const Rendered want = expected(view, map, 0.3f);
  for (const float depth : {0.25f, 1.0f, 1000.0f})
    expectSameLight(view, render(with(true, TrivialAccept::kFlat, depth), view, map, 0.3f).radiance,
                    want.radiance, map.photons.size());
}

// All tiles are diffuse and flat: much of the light is accepted by nodes, and none twice.
TEST(PhotonClusters, TrivialAcceptChangesNoFlatPicture) {
  const ViewSamples view = makeView({.width = 160, .height = 120, .lambertian = true, .bentNormals = false});
  const PhotonMap map = makePhotons(5000);
  for (const float radius : {0.2f, 0.8f}) {
    const Rendered want = expected(view, map, radius);
    for (const TrivialAccept trivial : {TrivialAccept::kFlat, TrivialAccept::kAll}) {
      const Rendered got = render(with(true, trivial), view, map, radius);
      expectSameLight(view, got.radiance, want.radiance, map.photons.size());
      const double accepted = got.stats.counter("photon_clusters.pairsAccepted");
      EXPECT_GT(accepted, 0.2 * want.stats.counter("photon_volumes.pairsContributing"));
      EXPECT_EQ(accepted + got.stats.counter("photon_clusters.pairsContributing"),
                want.stats.counter("photon_volumes.pairsContributing"));
    }
  }
}

TEST(PhotonClusters, TrivialAcceptLeavesBentNormalsAloneUnlessAskedTo) {
  const ViewSamples view = makeView({.lambertian = true});
  const PhotonMap map = makePhotons(3000);
  const Rendered want = expected(view, map, 0.5f);
  const Rendered exact = render(with(true, TrivialAccept::kFlat), view, map, 0.5f);
  EXPECT_EQ(exact.stats.counter("photon_clusters.pairsAccepted"), 0);
  expectSameLight(view, exact.radiance, want.radiance, map.photons.size());
  const Rendered all = render(with(true, TrivialAccept::kAll), view, map, 0.5f);
  EXPECT_GT(all.stats.counter("photon_clusters.pairsAccepted"), 0);
  EXPECT_FALSE(sameBytes(all.radiance, exact.radiance));
}

TEST(PhotonClusters, TrivialAcceptLeavesGlossySurfacesAlone) {
  const ViewSamples view = makeView({.bentNormals = false, .seed = 3});
  const PhotonMap map = makePhotons(3000);
  const Rendered want = expected(view, map, 0.5f);
  const Rendered got = render(with(true, TrivialAccept::kAll), view, map, 0.5f);
  EXPECT_GT(got.stats.counter("photon_clusters.pairsAccepted"), 0) << "every third tile is diffuse";
  expectSameLight(view, got.radiance, want.radiance, map.photons.size());
}

TEST(PhotonClusters, ConesSpareTests) {
  const ViewSamples view = makeView({.width = 160, .height = 120, .bentNormals = false});
  PhotonMap map = makePhotons(2000);
  for (std::size_t i = 0; i < map.photons.size(); i += 2)
    map.photons[i].direction = packDirection(-unpackDirection(map.photons[i].normal));
  const double without = render(plain(), view, map, 0.3f).stats.counter("photon_clusters.pairsTested");
  const double cones =
      render(with(true, TrivialAccept::kOff), view, map, 0.3f).stats.counter("photon_clusters.pairsTested");
  EXPECT_LT(cones, 0.7 * without);
}

TEST(PhotonClusters, EverySampleIsInOneCluster) {
  const ViewSamples view = makeView({.width = 300, .height = 150, .secondaryTiles = 20});
  Clusters clusters;
  for (const float depth : {0.25f, 4.0f}) {
    clusters.build(view, depth, bestSimdLevel());
    std::map<std::uint32_t, std::uint64_t> lanes;
    std::uint64_t before = 0;
    for (const Cluster& c : clusters.all()) {
      EXPECT_GE(c.key, before);
      before = c.key;
      EXPECT_EQ(lanes[c.tile] & c.lanes, 0u);
      lanes[c.tile] |= c.lanes;
    }
    for (std::uint32_t t = 0; t < view.tiles.size(); ++t)
      EXPECT_EQ(std::uint32_t(std::popcount(lanes[t])), view.tiles[t].count);
  }
}

TEST(PhotonClusters, NodesHoldTheirChildren) {
  const ViewSamples view = makeView({.width = 640, .height = 480, .secondaryTiles = 90});
  Clusters clusters;
  clusters.build(view, 1.0f, bestSimdLevel());
  ClusterTree tree;
  tree.build(clusters.all(), true, TrivialAccept::kFlat);
  ASSERT_GE(tree.levels().size(), 3u);
  EXPECT_LE(tree.levels().back().size(), std::size_t(kNodeWidth));
  for (std::size_t l = 1; l < tree.levels().size(); ++l) {
    const Level& level = tree.levels()[l];
    const Level& below = tree.levels()[l - 1];
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < level.size(); ++i) {
      EXPECT_EQ(level.firstChild[i], next);
      next += level.childCount(i);
      std::uint32_t samples = 0;
      for (std::uint32_t c = level.firstChild[i]; c < next; ++c) {
        samples += below.samples[c];
        EXPECT_EQ(below.parent[c], i);
        EXPECT_LE(level.lowerX[i], below.lowerX[c]);
        EXPECT_GE(level.upperZ[i], below.upperZ[c]);
      }
      EXPECT_EQ(level.samples[i], samples);
    }
    EXPECT_EQ(next, below.size());
  }
}

}  // namespace
}  // namespace isophote
