// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/block_estimate.h"
#include "stages/photon_volumes/estimate.h"
#include "stages/photon_volumes/photon_volumes.h"
#include "stages/photon_volumes/volumes.h"

namespace isophote {

using namespace photon_volumes;

struct PhotonVolumes::Scratch {
  std::vector<PhotonVolume> volumes;
  photon_estimate::BlockEstimate<PhotonVolume> estimate;
};

PhotonVolumes::PhotonVolumes(PhotonVolumesSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonVolumes::~PhotonVolumes() = default;
PhotonVolumes::PhotonVolumes(PhotonVolumes&&) noexcept = default;
PhotonVolumes& PhotonVolumes::operator=(PhotonVolumes&&) noexcept = default;

void PhotonVolumes::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const Stats::Scope scope = stats.scope("photon_volumes");
  Scratch& s = *scratch_;
  makeVolumes(in.map, in.radius, settings_, s.volumes);
  s.estimate.run({.stage = "photon_volumes",
                  .view = in.view,
                  .photons = s.volumes,
                  .kernel = uint(settings_.kernel),
                  .touch = touchFor(in.simd),
                  .loopFor = estimateFor,
                  .simd = in.simd},
                 out, stats, job);
  stats.peakBytes("photon_volumes.volumes", s.volumes.size() * sizeof(PhotonVolume));
}

}  // namespace isophote
