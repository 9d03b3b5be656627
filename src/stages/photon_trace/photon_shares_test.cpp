// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/photon_shares.h"

#include <gtest/gtest.h>

#include <vector>

namespace isophote {
namespace {

TEST(PhotonShares, LargestRemainderAndAtLeastOne) {
  std::vector<Light> lights(4);
  lights[0].power = 60;
  lights[1].power = 0;
  lights[2].power = 39.999f;
  lights[3].power = 0.001f;
  EXPECT_EQ(photonShares(lights, 10), (std::vector<std::uint32_t>{6, 0, 3, 1}));
  EXPECT_EQ(photonShares(lights, 1'000'000), (std::vector<std::uint32_t>{600'000, 0, 399'990, 10}));
  EXPECT_EQ(photonShares(lights, 2), (std::vector<std::uint32_t>{1, 0, 1, 1}));
  for (std::uint32_t n = 3; n < 200; ++n) {
    std::uint32_t sum = 0;
    for (const std::uint32_t share : photonShares(lights, n)) sum += share;
    EXPECT_EQ(sum, n);
  }
  lights[0].power = lights[2].power = lights[3].power = 0;
  EXPECT_EQ(photonShares(lights, 100), std::vector<std::uint32_t>(4, 0));
}

}  // namespace
}  // namespace isophote
