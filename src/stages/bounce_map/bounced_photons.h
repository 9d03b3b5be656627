// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/stats.h"
#include "stages/photon_trace/path_state.h"
#include "stages/photon_trace/photon_map.h"

#include <cstdint>
#include <vector>

namespace isophote {

/// Photons after their first scattering event, and the account of those that ended there.
struct BouncedPhotons {
  /// In order of light, block and pixel: the same for any number of threads.
  std::vector<PathState> photons;
  std::uint64_t emitted = 0;  ///< One a pixel through which light leaves.
  std::uint64_t hits = 0;     ///< Of them, those that met a surface.

  // Sums of mean-of-RGB power [W]. emitted = absorbed + escaped + what `photons` carry, up to roulette's
  // sampling error.
  double powerEmitted = 0;
  double powerAbsorbed = 0;
  double powerEscaped = 0;
};

/// Completes the account of a map some of whose paths started with `bounced.photons` by what came before
/// them, and the statistics' photonsEmitted and hitsPerBounce.
void addAccount(const BouncedPhotons& bounced, PhotonMap& map, Stats& stats);

}  // namespace isophote
