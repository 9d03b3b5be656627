// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/photon_clusters.h"

#include "support/sphere_tests.h"

namespace isophote {
namespace {

using namespace sphere_tests;

PhotonClusters with(bool cone, TrivialAccept trivial, float cellDepth = 1,
                    ClusterSize size = ClusterSize::k8x8) {
  PhotonClustersSettings settings;
  settings.cone = cone;
  settings.trivial = trivial;
  settings.cellDepth = cellDepth;
  settings.size = size;
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

TEST(PhotonClusters, SizeAndDepthOfTheCellsChangeNoPicture) {
  const ViewSamples view = makeView({.secondaryTiles = 9});
  const PhotonMap map = makePhotons(3000);
  const Rendered want = expected(view, map, 0.3f);
  for (const ClusterSize size :
       {ClusterSize::k4x4, ClusterSize::k8x4, ClusterSize::k8x8, ClusterSize::k16x8, ClusterSize::k16x16})
    expectSameLight(view, render(with(true, TrivialAccept::kFlat, 4, size), view, map, 0.3f).radiance,
                    want.radiance, map.photons.size());
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

}  // namespace
}  // namespace isophote
