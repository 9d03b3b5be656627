// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Photons that another stage has emitted and scattered once, and that go on here.
#include "base/error.h"
#include "stages/photon_trace/test_photons.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <vector>

namespace isophote {
namespace {

constexpr std::uint32_t kPaths = 300'000;  // more than a wave takes
constexpr std::uint32_t kBounces = 3;

/// A run in the grey furnace, and its paths as they stand after their first event: each has the same power.
struct Furnace {
  Scene scene = builtinScene("furnace-box");
  TraceScene trace{scene};
  PhotonMap whole;
  std::vector<PathState> starts;

  Furnace() {
    std::vector<TracedRay> rays;
    PhotonTrace stage({.photons = kPaths});
    Stats stats;
    stage.run({.trace = trace, .seed = 5, .bounces = kBounces, .rays = &rays}, whole, stats);
    std::vector<int> raysOfPath(kPaths, 0);
    for (const auto& [ray, light, path] : rays)
      if (++raysOfPath[path] == 2) {
        const vec3 power = vec3(scene.lights[light].power) / float(kPaths);
        starts.push_back(
            {ray.origin, 0.5f * pathDensityFactor(kLobeDiffuse, 1.0f), ray.direction, path, power, light});
      }
  }

  PhotonMap resumed(std::span<const PathState> from, std::uint32_t bounces = kBounces,
                    std::uint32_t emitted = 0) const {
    PhotonTrace stage({});
    PhotonMap map;
    Stats stats;
    const std::uint32_t pathsOfLight[] = {emitted};
    stage.run({.trace = trace, .seed = 5, .bounces = bounces, .pathsOfLight = pathsOfLight, .starts = from},
              map, stats);
    return map;
  }
};

/// Where each photon lies and how it got there, whatever the order.
std::multiset<std::array<float, 4>> places(const PhotonMap& map) {
  std::multiset<std::array<float, 4>> set;
  for (const Photon& p : map.photons) set.insert({p.position.x, p.position.y, p.position.z, float(p.bounce)});
  return set;
}

TEST(ResumedPaths, GoOnAsIfEmittedHere) {
  const Furnace furnace;
  const PhotonMap map = furnace.resumed(furnace.starts);
  EXPECT_EQ(map.hitsPerBounce[0], 0u);
  for (std::uint32_t b = 1; b <= kBounces; ++b)
    EXPECT_EQ(map.hitsPerBounce[b], furnace.whole.hitsPerBounce[b]);
  EXPECT_EQ(map.emitted, furnace.starts.size());
  EXPECT_TRUE(places(map) == places(furnace.whole));
  // Emission in the furnace is even to 2e-4 (see FurnaceStoresPowersOfTheAlbedo).
  for (std::uint32_t b = 1; b <= kBounces; ++b)
    EXPECT_NEAR(storedPower(map, b), storedPower(furnace.whole, b), 2e-4 * storedPower(map, b));
  const double power = double(furnace.scene.lights[0].power) * double(furnace.starts.size()) / kPaths;
  EXPECT_NEAR(map.powerEmitted, power, 1e-5 * power);
  // Roulette keeps or drops half of what is left at each event, of which there are two.
  const double sigma =
      0.5 * std::sqrt(2.0 * double(furnace.starts.size())) * power / double(furnace.starts.size());
  EXPECT_NEAR(map.powerAbsorbed + map.powerEscaped + map.powerEnded, power, 4 * sigma);
  for (const Photon& p : map.photons)
    ASSERT_NEAR(p.pathDensity, std::pow(5e-4f, float(p.bounce)), 1e-4f * p.pathDensity);
}

TEST(ResumedPaths, JoinThoseThatAreEmitted) {
  const Furnace furnace;
  const std::span<const PathState> starts = std::span(furnace.starts).first(1000);
  const PhotonMap both = furnace.resumed(starts, kBounces, 2000),
                  emitted = furnace.resumed({}, kBounces, 2000), resumed = furnace.resumed(starts);
  EXPECT_EQ(both.emitted, 3000u);
  EXPECT_EQ(emitted.emitted, 2000u);
  EXPECT_EQ(both.photons.size(), emitted.photons.size() + resumed.photons.size());
  EXPECT_NEAR(both.powerEmitted, emitted.powerEmitted + resumed.powerEmitted, 1e-9 * both.powerEmitted);
  EXPECT_NEAR(both.powerAbsorbed, emitted.powerAbsorbed + resumed.powerAbsorbed, 1e-9 * both.powerEmitted);
  for (std::uint32_t b = 0; b <= kBounces; ++b)
    EXPECT_EQ(both.hitsPerBounce[b], emitted.hitsPerBounce[b] + resumed.hitsPerBounce[b]);
}

TEST(ResumedPaths, EndAtTheLimitOnBounces) {
  const Furnace furnace;
  const PhotonMap one = furnace.resumed(furnace.starts, 1);
  EXPECT_EQ(one.photons.size(), furnace.starts.size());  // the room is closed
  EXPECT_NEAR(one.powerEnded, one.powerEmitted, 1e-5 * one.powerEmitted);
  const PhotonMap none = furnace.resumed(furnace.starts, 0);
  EXPECT_TRUE(none.photons.empty());
  EXPECT_EQ(none.powerEnded, none.powerEmitted);
}

TEST(ResumedPaths, CannotBeCountedOut) {
  const Furnace furnace;
  PhotonTrace stage({.photonsStored = 1000});
  PhotonMap map;
  Stats stats;
  try {
    stage.run({.trace = furnace.trace, .starts = furnace.starts}, map, stats);
    ADD_FAILURE() << "accepted";
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kBadUsage);
  }
}

}  // namespace
}  // namespace isophote
