// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/quality.h"

#include "base/error.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>

namespace isophote {
namespace {

constexpr std::array<std::string_view, 6> kDraft{"photon_trace.photons=20000", "frame.subsample=8",
                                                 "direct.areaSamples=1",       "frame.passes=1",
                                                 "frame.sparsePasses=1",       "frame.passRadius=1"};
/// Passes that all estimate at one pixel in 64 are the quickest way to a picture without visible noise.
constexpr std::array<std::string_view, 6> kPreview{"photon_trace.photons=50000", "frame.subsample=8",
                                                   "direct.areaSamples=1",       "frame.passes=8",
                                                   "frame.sparsePasses=8",       "frame.passRadius=0.75"};
constexpr std::array<std::string_view, 6> kFinal{"photon_trace.photons=200000", "frame.subsample=4",
                                                 "direct.areaSamples=1",        "frame.passes=256",
                                                 "frame.sparsePasses=1",        "frame.passRadius=0.5"};

constexpr std::array<Quality, 3> kQualities{{
    {"draft", "One quick frame, as a window shows it while things move: tenths of a second.", kDraft},
    {"preview", "Eight quick passes, edges smoothed: about a second.", kPreview},
    {"final", "256 passes at every pixel, which converge: minutes.", kFinal},
}};

}  // namespace

std::span<const Quality> qualities() { return kQualities; }

const Quality& qualityNamed(std::string_view name) {
  const auto found = std::ranges::find(kQualities, name, &Quality::name);
  if (found != kQualities.end()) return *found;
  std::array<std::string_view, kQualities.size()> names;
  std::ranges::transform(kQualities, names.begin(), &Quality::name);
  failUsage("--quality", "there is no quality \"{}\"{}; there is {}", name, suggestion(name, names),
            fmt::join(names, ", "));
}

}  // namespace isophote
