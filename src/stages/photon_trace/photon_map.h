// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "physics/photon.shared.h"
#include "physics/photon_differential.shared.h"

#include <array>
#include <cstdint>
#include <vector>

namespace isophote {

/// The photons of one pass and the account of where the emitted power went.
struct PhotonMap {
  /// In order of tracing, near photons mostly next to each other; the same for any number of threads.
  std::vector<Photon> photons;
  /// Of each photon where PhotonTrace::In::footprints asks for them, else empty.
  std::vector<PhotonFootprint> footprints;
  std::uint64_t emitted = 0;                 ///< Photon paths started.
  std::vector<std::uint64_t> hitsPerBounce;  ///< Surface hits after 0, 1, ... scattering events.

  // Sums over paths of mean-of-RGB power [W]. emitted = absorbed + escaped + ended, up to roulette's sampling
  // error.
  double powerEmitted = 0;
  double powerAbsorbed = 0;
  double powerEscaped = 0;
  double powerEnded = 0;  ///< Cut by the limit on bounces.
};

}  // namespace isophote
