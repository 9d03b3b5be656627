// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/photon_batches.h"

#include <algorithm>

namespace isophote {
namespace {

/// The map grows by moving, and estimators keep photons of their own.
constexpr std::uint64_t kBudgetShare = 4;

bool needsAllPhotons(const RenderSettings& settings) {
  const FrameSettings& frame = settings.frame;
  return frame.firstBounce == FirstBounce::kMap || frame.densityLayer ||
         settings.photonTrace.photonsStored > 0 || frame.estimator == Estimator::kBvh ||
         (frame.estimator == Estimator::kKdtree && settings.photonKdtree.nearest > 0);
}

}  // namespace

std::uint32_t photonBatches(const RenderSettings& settings, std::uint64_t memoryBudgetBytes) {
  if (needsAllPhotons(settings)) return 1;
  // A path stores a photon at every bounce at most.
  const bool footprints = settings.frame.estimator == Estimator::kBvh;
  const std::uint64_t bytesOfPhoton = sizeof(Photon) + (footprints ? sizeof(PhotonFootprint) : 0);
  const std::uint64_t bytesOfPath = 2 * bytesOfPhoton * settings.frame.bounces;
  const std::uint64_t share = std::max<std::uint64_t>(memoryBudgetBytes / kBudgetShare, 1);
  const std::uint64_t photons = settings.photonTrace.photons;
  return std::uint32_t(std::clamp<std::uint64_t>((photons * bytesOfPath + share - 1) / share, 1, photons));
}

}  // namespace isophote
