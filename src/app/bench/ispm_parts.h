// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/bench/suite.h"
#include "render/settings.h"

#include <cstdint>

namespace isophote::bench {

/// A row of the paper's table 2: what is set there.
struct IspmSetUp {
  std::uint32_t width, height;
  std::uint32_t photons;
  std::uint32_t bounces;
  std::uint32_t subsample;
};

/// --preset ispm with these settings, smaller where the context says so.
RenderSettings ispmSettings(const Context& context, const IspmSetUp& setUp);

/// The paper's Sponza of table 2, second row.
inline constexpr IspmSetUp kIspmSponza{1920, 1080, 6'240, 1, 4};

// Parts of the suite, each with tables, plots and pictures of its own.
void benchIspmFrames(Context& context);      ///< Table 2 and figure 10.
void benchIspmQuality(Context& context);     ///< Table 3.
void benchIspmCulling(Context& context);     ///< Figure 9.
void benchIspmUpsampling(Context& context);  ///< Figure 12.
void benchIspmScaling(Context& context);     ///< With threads and with the area of footprints.

}  // namespace isophote::bench
