// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/test_photons.h"

#include <gtest/gtest.h>

#include <cmath>

namespace isophote {
namespace {

/// In the furnace photons lie evenly: a disc holds photonsPerEstimate where pi r^2 n / A says so.
TEST(AutomaticRadius, FindsTheDensityOfAnEvenlyLitRoom) {
  for (const std::uint32_t photons : {2'000u, 20'000u, 200'000u}) {
    const PhotonMap map = traced(builtinScene("furnace-box"), {.photons = photons});
    const double density = double(map.photons.size()) / 24;  // the cube's walls [1/m^2]
    for (const float wanted : {20.0f, 100.0f}) {
      if (wanted / density > 0.5) continue;  // a disc must be small against a wall of 4 m^2
      const double expected = std::sqrt(double(wanted) / (double(kPi) * density));
      EXPECT_NEAR(double(automaticRadius(map, wanted)) / expected, 1.0, 0.15) << photons << " " << wanted;
    }
  }
}

TEST(AutomaticRadius, ScalesWithTheUnitAndIgnoresCausticsAndStrays) {
  PhotonMap map = traced(builtinScene("furnace-box"), {.photons = 20'000});
  const float radius = automaticRadius(map, 50);
  PhotonMap scaled = map;
  for (Photon& p : scaled.photons) p.position *= 1000.0f;
  EXPECT_NEAR(automaticRadius(scaled, 50), 1000.0f * radius, 0.01f * 1000.0f * radius);
  for (std::size_t i = 0; i < map.photons.size(); i += 20) map.photons[i].position = vec3(1, 0.5f, 0.5f);
  for (std::size_t i = 1; i < map.photons.size(); i += 50) map.photons[i].position *= 1e6f;
  EXPECT_NEAR(automaticRadius(map, 50), radius, 0.25f * radius);
}

/// Most photons lie in a crevice, as between a ceiling and a lamp that shines upwards too: the room decides.
TEST(AutomaticRadius, IgnoresACrevice) {
  PhotonMap map = traced(builtinScene("furnace-box"), {.photons = 20'000});
  PhotonMap rest;
  for (std::size_t i = 0; i < map.photons.size(); ++i) {
    Photon& photon = map.photons[i];
    if (i % 10 < 4)
      rest.photons.push_back(photon);
    else  // a few at its rim, ever farther out
      photon.position = vec3(-1, 0, 0) + (i % 50 == 9 ? float(i % 97) / 97.0f : 0.02f) * photon.position;
  }
  const float ofRest = automaticRadius(rest, 50);
  EXPECT_NEAR(automaticRadius(map, 50), ofRest, 0.2f * ofRest);
}

/// Half of the photons three times as strong as the others: (4 / 2)^2 / (10 / 2) = 0.8 of them count.
TEST(AutomaticRadius, CountsUnequalPhotonsByTheirNoise) {
  PhotonMap map = traced(builtinScene("furnace-box"), {.photons = 20'000});
  const float equal = automaticRadius(map, 50);
  for (std::size_t i = 0; i < map.photons.size(); i += 2) map.photons[i].power *= 3.0f;
  EXPECT_NEAR(automaticRadius(map, 50), equal / std::sqrt(0.8f), 0.03f * equal);
}

TEST(AutomaticRadius, SmallMaps) {
  PhotonMap map;
  EXPECT_EQ(automaticRadius(map, 50), 0.0f);
  Photon photon{};
  photon.normal = packDirection({0, 1, 0});
  map.photons.push_back(photon);
  EXPECT_EQ(automaticRadius(map, 50), 0.0f);
  photon.position = {3, 0, 4};
  map.photons.push_back(photon);
  // One neighbour at 5 m: 50 photons at that density.
  EXPECT_NEAR(automaticRadius(map, 50), 5.0f * std::sqrt(50.0f), 0.01f);
  // Photons on other surfaces do not count, however few lie on one.
  photon.normal = packDirection({1, 0, 0});
  for (int i = 1; i < 20; ++i) {
    photon.position = {float(i), 0, 0};
    map.photons.push_back(photon);
  }
  EXPECT_NEAR(automaticRadius(map, 50), 5.0f * std::sqrt(50.0f), 0.01f);
}

}  // namespace
}  // namespace isophote
