// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

namespace isophote {

/// How much work goes into a picture, in one word. It says nothing of how light is estimated, which is the
/// preset's business: over a preset, a quality replaces photons, subsampling and passes alone.
struct Quality {
  std::string_view name;
  std::string_view description;                   ///< One sentence.
  std::span<const std::string_view> assignments;  ///< "photon_trace.photons=20000", for setFromAssignment().
};

/// All qualities, from the quickest on.
std::span<const Quality> qualities();

/// Throws Error(kBadUsage) that lists the names.
const Quality& qualityNamed(std::string_view name);

}  // namespace isophote
