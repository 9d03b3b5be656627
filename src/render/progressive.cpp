// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/progressive.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

namespace isophote {

namespace {

/// What a later pass changes so that passes converge.
RenderSettings refined(RenderSettings settings, std::uint32_t pass) {
  if (pass >= settings.frame.sparsePasses) settings.frame.subsample = 1;
  settings.direct.shadows = areSoft(settings.direct.shadows) ? Shadows::kArea : Shadows::kTraced;
  settings.direct.blurRadius = 0;
  settings.photonKdtree.nearest = 0;
  settings.photonDirectional.cells = 16384;
  settings.photonDirectional.level = 0;
  settings.irradianceBlur.radius = 0;
  return settings;
}

/// mean += (x - mean) * weight.
void blend(const Image& x, float weight, Image& mean) {
  if (mean.pixels.size() != x.pixels.size()) mean = Image(x.width, x.height);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, x.pixels.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i)
      mean.pixels[i] += (x.pixels[i] - mean.pixels[i]) * weight;
  });
}

}  // namespace

float progressiveRadius(std::uint32_t pass) {
  constexpr double kAlpha = 2.0 / 3.0;
  // r_{i+1}^2 / r_i^2 = (i + alpha) / (i + 1) from i = 1 on, as gamma functions.
  const double i = double(pass) + 1.0;
  const double squared =
      std::exp(std::lgamma(i + kAlpha) - std::lgamma(1.0 + kAlpha) - std::lgamma(i + 1.0) + std::lgamma(2.0));
  return float(std::sqrt(squared));
}

float radiusOfPass(const FrameSettings& frame, std::uint32_t pass) {
  return pass > 0 ? frame.passRadius * progressiveRadius(pass) : 1.0f;
}

ProgressiveRenderer::ProgressiveRenderer(const TraceScene& trace, const RenderSettings& settings)
    : trace_(trace), settings_(settings), renderer_(std::make_unique<CpuRenderer>(trace, settings)) {}

void ProgressiveRenderer::addPass(const Camera& camera, Stats& stats, const Job& job) {
  if (passes_ > 0) {
    const RenderSettings settings = refined(settings_, passes_);
    if (!std::exchange(refining_, true) ||
        renderer_->settings().frame.subsample != settings.frame.subsample) {
      renderer_.reset();  // Its memory serves the next.
      renderer_ = std::make_unique<CpuRenderer>(trace_, settings);
    }
  }
  const float radius = passes_ > 0 ? firstRadius_ * radiusOfPass(settings_.frame, passes_) : 0.0f;
  const float used = renderer_->renderPass(camera, {passes_, radius}, pass_, stats, job);
  if (passes_ == 0) {
    firstRadius_ = used;
    mean_ = Film();
    mean_.metadata = metadataOf(settings_);
  }
  ++passes_;
  const float weight = 1.0f / float(passes_);
  blend(pass_.colour, weight, mean_.colour);
  for (const auto& [name, image] : pass_.layers) blend(image, weight, mean_.layers[name]);
  stats.setCounter("passes", double(passes_));
}

void addPasses(ProgressiveRenderer& renderer, const Camera& camera, const FrameSettings& frame, Stats& stats,
               const Job& job, const std::function<void()>& afterPass) {
  using Clock = std::chrono::steady_clock;
  const auto start = Clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  const double seconds =
      frame.seconds > 0.0f ? double(frame.seconds) : std::numeric_limits<double>::infinity();
  const double most = frame.passes > 1 || frame.seconds <= 0.0f ? double(frame.passes)
                                                                : std::numeric_limits<double>::infinity();
  double longest = 0;  // What a pass has taken; one that would end too late is not begun.
  while (renderer.passes() == 0 || (double(renderer.passes()) < most && elapsed() + longest <= seconds)) {
    const double before = elapsed();
    const double done = std::max(double(renderer.passes()) / most, before / seconds);
    const double step = std::max(1.0 / most, std::min(longest / seconds, 1.0));
    renderer.addPass(camera, stats, job.part(std::min(done, 1.0), std::min(done + step, 1.0)));
    longest = std::max(longest, elapsed() - before);
    if (afterPass) afterPass();
  }
}

void ProgressiveRenderer::resume(Film mean, std::uint32_t passes, float firstRadius) {
  mean_ = std::move(mean);
  mean_.metadata = metadataOf(settings_);
  passes_ = passes;
  firstRadius_ = firstRadius;
}

}  // namespace isophote
