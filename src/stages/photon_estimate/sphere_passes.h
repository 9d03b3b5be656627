// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "stages/photon_estimate/sphere_loops.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace isophote::photon_estimate {

/// Works off photons of one radius in as many sub-passes as it takes for their spheres, and for lists of
/// them, to keep to a part of the memory budget each; returns how many. Of each: fill(first, maxBytes) puts
/// `spheres` from `first` on into lists, as PhotonLists::build, and work(job) reads these. Throws
/// Error(kBadUsage) that names `setting` where there are photons and the radius is not a positive number.
template <class Fill, class Work>
std::uint32_t forEachSubPass(std::span<const Photon> photons, float radius, std::string_view setting,
                             std::vector<PhotonSphere>& spheres, const Job& job, Fill&& fill, Work&& work) {
  constexpr std::uint64_t kBudgetShare = 8;
  constexpr std::uint64_t kLargestLists = std::uint64_t(256) << 20;  // [bytes]
  constexpr std::uint64_t kFewestSpheres = 1024;                     // They do not matter.
  const std::uint64_t share = job.memoryBudgetBytes / kBudgetShare;
  const std::size_t window = std::max(share / sizeof(PhotonSphere), kFewestSpheres);
  const double all = double(photons.size());
  std::uint32_t passes = 0;
  for (std::size_t begin = 0; begin < photons.size(); begin += window) {
    makeSpheres(photons.subspan(begin, std::min(window, photons.size() - begin)), radius, setting, spheres);
    for (std::uint32_t first = 0; first < spheres.size(); ++passes) {
      job.throwIfStopped();
      const std::uint32_t taken = fill(first, std::min(kLargestLists, share));
      work(job.part(double(begin + first) / all, double(begin + first + taken) / all));
      first += taken;
    }
  }
  return passes;
}

}  // namespace isophote::photon_estimate
