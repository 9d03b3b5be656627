// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_estimate/photon_lists.h"

namespace isophote::photon_estimate {

std::uint32_t PhotonLists::place(std::size_t lists, std::uint64_t maxBytes) {
  const std::size_t chunks = lists > 0 ? counts_.size() / lists : 0;
  const std::uint64_t most = maxBytes / (2 * sizeof(std::uint32_t));
  begin_.assign(lists + 1, 0);
  std::uint32_t taken = 0;
  std::uint64_t entries = 0;
  for (; taken < chunks; ++taken) {
    std::uint32_t* const counts = counts_.data() + taken * lists;
    std::uint64_t more = 0;
    for (std::size_t list = 0; list < lists; ++list) more += counts[list];
    if (taken > 0 && entries + more > most) break;
    entries += more;
    for (std::size_t list = 0; list < lists; ++list) {
      const std::size_t before = begin_[list + 1];
      begin_[list + 1] += counts[list];
      counts[list] = std::uint32_t(before);
    }
  }
  for (std::size_t list = 0; list < lists; ++list) begin_[list + 1] += begin_[list];
  photons_.resize(entries);
  return taken;
}

}  // namespace isophote::photon_estimate
