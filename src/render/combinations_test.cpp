// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/combinations.h"

#include "base/error.h"
#include "render/cpu_renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace isophote {
namespace {

/// Settings that each refusal is about, in the table's order.
std::vector<RenderSettings> refused() {
  RenderSettings stored, footprints, blurred;
  stored.frame.firstBounce = footprints.frame.firstBounce = FirstBounce::kMap;
  stored.photonTrace.photonsStored = 1000;
  footprints.frame.estimator = Estimator::kBvh;
  blurred.direct.shadows = Shadows::kPcss;
  blurred.direct.blurRadius = 0.1f;
  return {stored, footprints, blurred};
}

TEST(Combinations, EachRefusalIsGivenWithItsSentence) {
  const std::vector<RenderSettings> settings = refused();
  ASSERT_EQ(settings.size(), refusals().size());
  for (std::size_t i = 0; i < settings.size(); ++i) {
    try {
      refuseWhatCannotCombine(settings[i]);
      ADD_FAILURE() << refusals()[i].setting << " was not refused";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kBadUsage);
      const std::string_view sentence = error.what();
      EXPECT_NE(sentence.find(refusals()[i].setting), std::string_view::npos) << sentence;
      EXPECT_NE(sentence.find(refusals()[i].because), std::string_view::npos) << sentence;
    }
  }
}

/// Every preset, estimator, first bounce and kind of shadow: refused, or rendered.
TEST(Combinations, WhatIsNotRefusedRenders) {
  const Scene scene = loadScene("colour-bleed");
  const TraceScene trace(scene);
  int rendered = 0, refusedOnes = 0;
  for (const PresetInfo& preset : presets())
    for (std::uint32_t estimator = 0; estimator < EnumNames<Estimator>::names.size(); ++estimator)
      for (std::uint32_t shadows = 0; shadows < EnumNames<Shadows>::names.size(); ++shadows)
        for (const FirstBounce first : {FirstBounce::kTraced, FirstBounce::kMap}) {
          RenderSettings settings = presetSettings(preset.name);
          settings.frame.width = settings.frame.height = 16;
          settings.frame.bounces = 1;
          settings.photonTrace.photons = 300;
          settings.photonTrace.photonsStored = 0;
          settings.frame.estimator = Estimator(estimator);
          settings.frame.firstBounce = first;
          settings.direct.shadows = Shadows(shadows);
          settings.direct.shadowResolution = 32;
          settings.direct.lightRadius = 0.1f;
          const bool isRefused = std::ranges::any_of(
              refusals(), [&](const Refusal& refusal) { return refusal.applies(settings); });
          Film film;
          Stats stats;
          const auto render = [&] {
            CpuRenderer(trace, settings).render(scene.cameras.front(), film, stats);
          };
          if (isRefused) {
            EXPECT_THROW(render(), Error);
          } else {
            EXPECT_NO_THROW(render())
                << preset.name << ", estimator " << estimator << ", shadows " << shadows;
            EXPECT_GT(stats.counter("photonsStored"), 0.0) << preset.name;
          }
          ++(isRefused ? refusedOnes : rendered);
        }
  EXPECT_GT(rendered, 100);
  EXPECT_GT(refusedOnes, 0);
}

}  // namespace
}  // namespace isophote
