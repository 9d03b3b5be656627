// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/combinations.h"

#include "base/error.h"

#include <string>

namespace isophote {
namespace {

bool usesBounceMaps(const RenderSettings& s) {
  return s.frame.bounces > 0 && s.frame.firstBounce == FirstBounce::kMap;
}

constexpr Refusal kRefusals[] = {
    {"photon_trace.photonsStored",
     "a bounce map emits one photon a pixel; set photon_trace.photons, or frame.firstBounce=traced",
     [](const RenderSettings& s) { return usesBounceMaps(s) && s.photonTrace.photonsStored > 0; }},
    {"frame.firstBounce",
     "photons of a bounce map leave no footprints; set frame.firstBounce=traced, or another estimator",
     [](const RenderSettings& s) { return usesBounceMaps(s) && s.frame.estimator == Estimator::kBvh; }},
    {"direct.blurRadius",
     "only gathered shadows can be blurred by a radius of their own; set direct.shadows=gathered, or the "
     "radius to 0",
     [](const RenderSettings& s) {
       return s.direct.blurRadius > 0.0f && s.direct.shadows != Shadows::kGathered;
     }},
};

}  // namespace

std::span<const Refusal> refusals() { return kRefusals; }

void refuseWhatCannotCombine(const RenderSettings& settings) {
  for (const Refusal& refusal : kRefusals)
    if (refusal.applies(settings)) failUsage(std::string(refusal.setting), "{}", refusal.because);
}

}  // namespace isophote
