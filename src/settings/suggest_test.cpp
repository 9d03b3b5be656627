// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "settings/suggest.h"

#include <gtest/gtest.h>

#include <array>

namespace isophote {
namespace {

TEST(Suggest, DistanceCountsEdits) {
  EXPECT_EQ(editDistance("radius", "radius"), 0u);
  EXPECT_EQ(editDistance("radiu", "radius"), 1u);
  EXPECT_EQ(editDistance("raidus", "radius"), 1u);
  EXPECT_EQ(editDistance("photon-trace", "photon_Trace"), 0u);
  EXPECT_EQ(editDistance("", "abc"), 3u);
  EXPECT_EQ(editDistance("kitten", "sitting"), 3u);
}

TEST(Suggest, NamesTheNearestOnly) {
  const std::array<std::string_view, 3> keys{"photon_trace.photons", "photon_trace.radius",
                                             "photon_volumes.radius"};
  EXPECT_EQ(suggestion("photon_trace.radiu", keys), " (did you mean \"photon_trace.radius\"?)");
  EXPECT_EQ(suggestion("photon_volume.radius", keys), " (did you mean \"photon_volumes.radius\"?)");
  EXPECT_EQ(suggestion("elephant", keys), "");
  EXPECT_EQ(suggestion("", keys), "");
}

}  // namespace
}  // namespace isophote
