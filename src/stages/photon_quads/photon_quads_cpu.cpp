// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_quads/photon_quads.h"
#include "stages/photon_quads/quads.h"

namespace isophote {

using namespace photon_quads;

struct PhotonQuads::Scratch {
  std::vector<PhotonQuad> quads;
  photon_estimate::BlockEstimate<PhotonQuad> estimate;
};

PhotonQuads::PhotonQuads(PhotonQuadsSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonQuads::~PhotonQuads() = default;
PhotonQuads::PhotonQuads(PhotonQuads&&) noexcept = default;
PhotonQuads& PhotonQuads::operator=(PhotonQuads&&) noexcept = default;

void PhotonQuads::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  const Stats::Scope scope = stats.scope("photon_quads");
  Scratch& s = *scratch_;
  const std::size_t culled = makeQuads(in, settings_, s.quads);
  s.estimate.run({.stage = "photon_quads",
                  .view = in.view,
                  .photons = s.quads,
                  .kernel = uint(settings_.falloff),
                  .touch = touchFor(settings_.corners, in.simd),
                  .loopFor = loopsFor(settings_.corners),
                  .simd = in.simd},
                 out, stats, job);
  stats.setCounter("photon_quads.culled", double(culled));
  stats.peakBytes("photon_quads.quads", s.quads.capacity() * sizeof(PhotonQuad));
}

}  // namespace isophote
