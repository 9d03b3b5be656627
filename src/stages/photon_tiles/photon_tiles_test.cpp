// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_tiles/photon_tiles.h"

#include "support/sphere_tests.h"

namespace isophote {
namespace {

using namespace sphere_tests;

PhotonTiles make() { return PhotonTiles(PhotonTilesSettings{}); }

TEST(PhotonTiles, MatchesVolumesWhereverTheEyeIs) {
  expectMatchesVolumesWhereverTheEyeIs(make, "photon_tiles.pairsContributing");
}
TEST(PhotonTiles, TheSameBytesWithAnyNumberOfThreads) { expectSameBytesWithAnyNumberOfThreads(make); }
TEST(PhotonTiles, EveryInstructionSetGivesTheSameBytes) { expectSameBytesOfEveryInstructionSet(make); }
TEST(PhotonTiles, ASmallMemoryBudgetGivesTheSamePicture) {
  expectSamePictureWithinASmallMemoryBudget(make, "photon_tiles.subPasses");
}
TEST(PhotonTiles, ASecondRunOverwritesTheFirst) { expectASecondRunOverwritesTheFirst(make); }
TEST(PhotonTiles, StopsAndRefusesARadiusOfZero) { expectStopsAndRefusesARadiusOfZero(make); }

// A tile tests no photon that lies in front of its nearest sample or behind its farthest one by a radius.
TEST(PhotonTiles, NearAndFarPlanesCutTheList) {
  const ViewSamples view = makeView({.width = 32, .height = 32, .eye = {0, 0, 0.5f}, .lambertian = true});
  PhotonMap map = makePhotons(200);
  for (Photon& p : map.photons) p.position = vec3(0, 0, 0.2f) - 0.05f * p.position;
  const Rendered got = render(make(), view, map, 0.3f);
  EXPECT_EQ(got.stats.counter("photon_tiles.pairsTested"), 0);
  for (Photon& p : map.photons) p.position.z = -0.9f;
  EXPECT_GT(render(make(), view, map, 0.3f).stats.counter("photon_tiles.pairsTested"), 0);
}

}  // namespace
}  // namespace isophote
