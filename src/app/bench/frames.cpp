// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/frames.h"

#include "render/cpu_renderer.h"
#include "render/progressive.h"
#include "render/yardstick.h"

#include <algorithm>

namespace isophote::bench {
namespace {

/// Adds what a frame's stages took; a stage that is met for the first time gets samples of its own.
void addStages(FrameTimes& times, const Stats& stats) {
  for (const auto& [name, milliseconds] : stats.stages()) {
    const auto found = std::ranges::find(times.stagesMs, name, &std::pair<std::string, Samples>::first);
    Samples& samples =
        found != times.stagesMs.end() ? found->second : times.stagesMs.emplace_back(name, Samples()).second;
    samples.add(milliseconds);
  }
}

}  // namespace

const Samples& FrameTimes::stage(std::string_view name) const {
  static const Samples kNone;
  for (const auto& [stageName, samples] : stagesMs)
    if (stageName == name) return samples;
  return kNone;
}

double FrameTimes::stagesMedian(std::initializer_list<std::string_view> names) const {
  double sum = 0;
  for (const std::string_view name : names)
    if (const Samples& samples = stage(name); !samples.empty()) sum += samples.median();
  return sum;
}

double primaryRaysMs(const TraceScene& trace, const Camera& camera, std::uint32_t width,
                     std::uint32_t height) {
  const CameraRays rays = cameraRays(camera, int(width), int(height));
  std::uint64_t met = 0;
  const double milliseconds =
      millisecondsOf([&] { met = tracePrimaryRays(trace, rays, int(width), int(height)); });
  return met <= std::uint64_t(width) * height ? milliseconds : 0.0;  // `met` keeps the work from going away.
}

FrameTimes measureFrames(Context& context, const TraceScene& trace, const Camera& camera,
                         const RenderSettings& settings, std::uint32_t mostRepeats) {
  FrameTimes times;
  RenderSettings shown = settings;
  shown.frame.layers = false;
  CpuRenderer renderer(trace, shown);
  bool warm = false;
  const auto round = [&] {
    times.last = Stats();
    const double before = processorMilliseconds();
    times.clockMs.add(
        millisecondsOf([&] { renderer.render(camera, times.film, times.last, context.job()); }));
    times.processorMs.add(processorMilliseconds() - before);
    if (warm) addStages(times, times.last);
    warm = true;
    times.primaryRaysMs.add(primaryRaysMs(trace, camera, shown.frame.width, shown.frame.height));
  };
  context.repeat({&times.clockMs, &times.processorMs, &times.primaryRaysMs}, round, mostRepeats);
  return times;
}

Image convergedByPhotons(Context& context, const TraceScene& trace, const Camera& camera,
                         const RenderSettings& like, std::uint32_t photons, std::uint32_t passes) {
  RenderSettings settings;
  settings.frame = like.frame;
  settings.frame.firstBounce = FirstBounce::kTraced;
  settings.frame.estimator = Estimator::kTiles;
  settings.frame.subsample = 1;
  settings.frame.layers = false;
  settings.photonTrace.photons = photons;
  ProgressiveRenderer renderer(trace, settings);
  for (std::uint32_t i = 0; i < passes; ++i) {
    Stats stats;
    renderer.addPass(camera, stats, context.job().part(double(i) / passes, double(i + 1) / passes));
  }
  return renderer.film().colour;
}

}  // namespace isophote::bench
