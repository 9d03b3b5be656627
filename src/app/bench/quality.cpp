// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/quality.h"

#include "base/error.h"
#include "image/compare.h"
#include "image/files.h"
#include "render/progressive.h"
#include "render/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <numeric>

namespace isophote::bench {

namespace {

/// Where the path-traced picture of these settings is kept. What it was made with is in the name, so that
/// another one is never taken for it.
std::filesystem::path referencePath(const std::string& scene, const ReferenceSettings& s,
                                    const QualityBench& bench) {
  std::string stem = std::filesystem::path(scene).stem().string();
  for (char& c : stem)
    if (c == '/' || c == ' ') c = '-';
  return bench.references /
         fmt::format("{}-{}x{}-{}bounces-{}spp.exr", stem, s.width, s.height, s.bounces, s.spp);
}

double meanFlip(const Image& shown, const Image& reference) {
  const std::vector<float> errors = flipErrors(shown, reference);
  return std::accumulate(errors.begin(), errors.end(), 0.0) / double(errors.size());
}

}  // namespace

const std::vector<QualityWay>& qualityWays() {
  static const std::vector<QualityWay> ways = [] {
    std::vector<QualityWay> list{
        {"sparse", {"photon_trace.photons=50000", "frame.subsample=8", "frame.sparsePasses=64"}}};
    for (const char* estimator : EnumNames<Estimator>::names)
      list.push_back(
          {estimator, {fmt::format("frame.estimator={}", estimator)}, {"photon_trace.photons=50000"}});
    return list;
  }();
  return ways;
}

Image convergedPicture(const Scene& scene, const std::string& name, const Camera& camera,
                       const QualityBench& bench, std::uint32_t bounces, const Job& job) {
  ReferenceSettings settings;
  settings.width = bench.width;
  settings.height = bench.height;
  settings.spp = bench.spp;
  settings.bounces = bounces;
  if (bench.references.empty()) {
    Stats stats;
    return renderReference(scene, camera, settings, stats, job).colour;
  }
  const std::filesystem::path path = referencePath(name, settings, bench);
  if (std::filesystem::exists(path)) {
    Film film = readFilm(path, job.memoryBudgetBytes);
    if (film.colour.width != int(bench.width) || film.colour.height != int(bench.height))
      failInput(path.string(), "is not the picture that its name says; remove it");
    return std::move(film.colour);
  }
  Stats stats;
  Film film = renderReference(scene, camera, settings, stats, job);
  writeFilm(path, film);
  return std::move(film.colour);
}

std::vector<QualityPoint> convergence(const TraceScene& trace, const Camera& camera,
                                      const RenderSettings& settings, double seconds, const Image& reference,
                                      Image& last, const Job& job) {
  using Clock = std::chrono::steady_clock;
  const Image shownReference = displayed(reference, {});
  std::vector<QualityPoint> points;
  double spent = 0, processor = 0, judgedAt = 0;
  ProgressiveRenderer renderer(trace, settings);
  while (spent < seconds) {
    const auto start = Clock::now();
    const std::clock_t processorStart = std::clock();
    Stats stats;
    renderer.addPass(camera, stats, job.part(std::min(spent / seconds, 1.0), 1.0));
    spent += std::chrono::duration<double>(Clock::now() - start).count();
    processor += double(std::clock() - processorStart) / CLOCKS_PER_SEC;
    const Image shown = displayed(renderer.film().colour, {});
    QualityPoint& point = points.emplace_back(
        QualityPoint{renderer.passes(), spent, processor, psnrOf(shown, shownReference), std::nullopt});
    if (spent < 1.1 * judgedAt && spent < seconds) continue;
    judgedAt = spent;
    point.flip = meanFlip(shown, shownReference);
  }
  last = renderer.film().colour;
  return points;
}

std::optional<double> psnrAt(const std::vector<QualityPoint>& points, double seconds) {
  std::optional<double> psnr;
  for (const QualityPoint& point : points)
    if (point.seconds <= seconds) psnr = point.psnr;
  return psnr;
}

std::optional<double> secondsTo(const std::vector<QualityPoint>& points, double psnr) {
  for (const QualityPoint& point : points)
    if (point.psnr >= psnr) return point.seconds;
  return std::nullopt;
}

std::optional<double> secondsToFlip(const std::vector<QualityPoint>& points, double flip) {
  for (const QualityPoint& point : points)
    if (point.flip && *point.flip <= flip) return point.seconds;
  return std::nullopt;
}

}  // namespace isophote::bench
