// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/photon_shares.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace isophote {

std::vector<std::uint32_t> photonShares(std::span<const Light> lights, std::uint32_t photons) {
  std::vector<std::uint32_t> shares(lights.size(), 0);
  double totalPower = 0;
  for (const Light& light : lights) totalPower += std::max(double(light.power), 0.0);
  if (!(totalPower > 0)) return shares;

  std::vector<std::uint32_t> order;  // lights with power
  std::vector<double> remainder(lights.size(), 0.0);
  std::int64_t left = photons;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    if (!(lights[i].power > 0.0f)) continue;
    const double quota = double(photons) * double(lights[i].power) / totalPower;
    shares[i] = std::uint32_t(std::max(std::floor(quota), 1.0));
    remainder[i] = quota - double(shares[i]);
    left -= shares[i];
    order.push_back(i);
  }
  // The rest goes, one each, to the lights that rounding has cost most.
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return remainder[a] > remainder[b]; });
  for (std::size_t k = 0; left > 0; k = (k + 1) % order.size(), --left) ++shares[order[k]];
  // What weak lights were given beyond their quota is taken from the largest.
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return shares[a] > shares[b]; });
  for (const std::uint32_t i : order) {
    const std::int64_t taken = std::clamp<std::int64_t>(-left, 0, std::int64_t(shares[i]) - 1);
    shares[i] -= std::uint32_t(taken);
    left += taken;
  }
  return shares;
}

}  // namespace isophote
