// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// IGPM: photons of a leaf (table 1), sizes of footprints (table 3) and kernels (figure 4).
#include "app/bench/frames.h"
#include "app/bench/igpm_parts.h"
#include "stages/photon_estimate/photon_ellipsoid.shared.h"

#include <fmt/format.h>

#include <algorithm>

namespace isophote::bench {
namespace {

constexpr std::array<std::uint32_t, 9> kLeaves{2, 4, 8, 16, 32, 64, 128, 256, 512};

/// Estimates of one scene and way to split with every threshold, in turns; the last one is the automatic.
std::array<Samples, kLeaves.size() + 1> leafTimes(Context& context, const IgpmScene& scene,
                                                  const IgpmEstimate& estimate, PhotonSplit split) {
  std::array<Samples, kLeaves.size() + 1> times;
  std::vector<PhotonBvh> stages;
  PhotonBvhSettings settings = scene.settings.photonBvh;
  settings.split = split;
  for (const std::uint32_t leaf : kLeaves) {
    settings.leafPhotons = leaf;
    stages.emplace_back(settings);
  }
  settings.leafPhotons = 0;
  stages.emplace_back(settings);
  std::array<Samples*, kLeaves.size() + 1> all{};
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = &times[i];
  Radiance out;
  context.repeat(std::span<Samples* const>(all), [&] {
    for (std::size_t i = 0; i < stages.size(); ++i) {
      Stats stats;
      times[i].add(millisecondsOf([&] { stages[i].run(estimate.in(), out, stats, context.job()); }));
    }
  });
  return times;
}

Table leavesTable() {
  Table table{
      .id = "table1",
      .title = "Table 1: photons of a leaf",
      .caption =
          "Hierarchy and estimate together, by the largest number of photons in a leaf. Paper: frames a "
          "second "
          "on a GeForce GTX 280; both columns of the automatic leaf say what part of the best speed it "
          "reaches. \"linear\" splits along a Morton curve, \"volume\" by the voxel volume heuristic.",
      .columns = {{"scene"}, {"split"}}};
  for (const std::uint32_t leaf : kLeaves)
    table.columns.push_back({std::to_string(leaf), Source::kHere, "ms"});
  table.columns.push_back({"automatic", Source::kHere, "ms"});
  table.columns.push_back({"best leaf", Source::kPaper});
  table.columns.push_back({"best leaf", Source::kHere});
  table.columns.push_back({"automatic of best, mean", Source::kPaper});
  table.columns.push_back({"automatic of best", Source::kHere});
  return table;
}

/// Speeds as parts of the best one, over the photons of a leaf.
Series relative(std::string name, Source source, const std::array<double, kLeaves.size()>& speeds) {
  const double best = std::ranges::max(speeds);
  Series series{.name = std::move(name), .source = source};
  for (std::size_t i = 0; i < speeds.size() && best > 0; ++i)
    series.points.emplace_back(kLeaves[i], speeds[i] / best);
  return series;
}

void addLeaves(Context& context, const IgpmScene& scene, PhotonSplit split, Table& table, Plot& plot) {
  const bool linear = split == PhotonSplit::kMorton;
  const IgpmEstimate estimate = igpmEstimate(scene);
  const auto times = leafTimes(context, scene, estimate, split);
  std::vector<Cell> row{scene.choice->name, linear ? "linear" : "volume"};
  std::array<double, kLeaves.size()> speeds{};
  for (std::size_t i = 0; i < speeds.size(); ++i) speeds[i] = 1000 / times[i].median();
  for (const Samples& samples : times) row.emplace_back(samples);
  const auto& paper = linear ? scene.column->leavesMorton : scene.column->leavesVolume;
  const auto leafOf = [](const auto& list) {
    return double(kLeaves[std::size_t(std::ranges::max_element(list) - list.begin())]);
  };
  row.push_back(paper[0] > 0 ? Cell(leafOf(paper)) : Cell());
  row.emplace_back(leafOf(speeds));
  row.emplace_back(0.988);  // Its mean over the scenes, of either split.
  row.emplace_back(1000 / times.back().median() / std::ranges::max(speeds));
  table.rows.push_back(std::move(row));
  if (!linear) return;
  plot.series.push_back(relative(scene.choice->scene.name, Source::kHere, speeds));
  if (paper[0] > 0)
    plot.series.push_back(relative(fmt::format("paper, {}", scene.column->name), Source::kPaper, paper));
}

/// Part of the semi-axes in each step of 5 cm, two a photon, before they are limited.
std::array<double, 21> radiiOf(const IgpmScene& scene, const PhotonMap& map) {
  constexpr double kStep = 0.05;
  const PhotonBvhSettings& s = scene.settings.photonBvh;
  const FootprintSmoothing smoothing{s.smoothing, s.smoothingCaustic, s.compression, s.referenceLength};
  std::array<double, 21> parts{};
  for (std::size_t i = 0; i < map.photons.size(); ++i) {
    const PhotonFootprint& f = map.footprints[i];
    const FootprintAxes axes = footprintAxes(f, unpackDirection(map.photons[i].normal));
    for (const float radius : {axes.majorRadius, axes.minorRadius}) {
      const double smoothed = double(smoothedRadius(smoothing, radius, f.spacing, f.scattered));
      parts[std::size_t(std::clamp(smoothed / kStep, 0.0, double(parts.size() - 1)))] += 1;
    }
  }
  for (double& part : parts) part /= std::max(2.0 * double(map.photons.size()), 1.0);
  return parts;
}

std::string rangeOf(std::size_t step, std::size_t steps) {
  if (step + 1 == steps) return "> 1.00";
  return fmt::format("{:.2f} - {:.2f}", 0.05 * double(step), 0.05 * double(step + 1));
}

}  // namespace

void benchIgpmRadii(Context& context, const std::vector<IgpmScene>& scenes) {
  if (scenes.empty() || !context.hasTimeFor("table 3, sizes of footprints", 0.5)) return;
  Table table{.id = "table3",
              .title = "Table 3: sizes of footprints",
              .caption = "Semi-axes in metres, two a photon, as parts of all [%]; not yet limited to 0.7 m.",
              .columns = {{"semi-axis [m]"}}};
  Plot plot{.id = "table3",
            .title = table.title,
            .caption = "Part of the semi-axes in each step of 5 cm.",
            .x = {"semi-axis [m]"},
            .y = {"part [%]"}};
  for (const IgpmScene& scene : scenes) {
    std::array<double, 21> here = radiiOf(scene, igpmEstimate(scene).map), paper{};
    double all = 0;
    for (const std::uint32_t count : scene.column->radii) all += count;
    for (std::size_t i = 0; i < paper.size(); ++i) paper[i] = scene.column->radii[i] / all;
    table.columns.push_back({scene.column->name, Source::kPaper, "%"});
    table.columns.push_back({scene.choice->name, Source::kHere, "%"});
    table.rows.resize(paper.size());
    Series ours{.name = scene.choice->scene.name},
        theirs{.name = fmt::format("paper, {}", scene.column->name), .source = Source::kPaper};
    for (std::size_t i = 0; i < paper.size(); ++i) {
      if (table.rows[i].empty()) table.rows[i].emplace_back(rangeOf(i, paper.size()));
      table.rows[i].emplace_back(100 * paper[i]);
      table.rows[i].emplace_back(100 * here[i]);
      ours.points.emplace_back(0.05 * (double(i) + 0.5), 100 * here[i]);
      theirs.points.emplace_back(0.05 * (double(i) + 0.5), 100 * paper[i]);
    }
    plot.series.push_back(std::move(theirs));
    plot.series.push_back(std::move(ours));
  }
  context.add(std::move(table));
  context.add(std::move(plot));
}

void benchIgpmKernels(Context& context, const IgpmScene& ring) {
  if (!context.hasTimeFor("figure 4, kernels", 1)) return;
  Table table{.id = "figure4",
              .title = "Figure 4: the kernel",
              .caption =
                  "Paper: frames of its ring at 6.24 and 6.12 a second, the picture a little better with "
                  "Epanechnikov's kernel.",
              .columns = {{"kernel"},
                          {"frame", Source::kPaper, "ms"},
                          {"frame", Source::kHere, "ms"},
                          {"PSNR", Source::kHere, "dB"},
                          {"FLIP", Source::kHere},
                          {"primary rays", Source::kYardstick, "ms"}}};
  const Image converged = convergedByPhotons(context, *ring.trace, ring.camera(), ring.settings,
                                             context.photons(400'000), context.quick() ? 4 : 32);
  PictureSet set{.id = "figure4",
                 .title = "Figure 4: diffuse light and a caustic from one hierarchy",
                 .caption = "",
                 .reference = shownPicture("many passes", converged)};
  RenderSettings settings = ring.settings;
  for (const auto& [kernel, paper] :
       {std::pair(Kernel::kConstant, 6.24), std::pair(Kernel::kEpanechnikov, 6.12)}) {
    settings.photonBvh.kernel = kernel;
    const FrameTimes times = measureFrames(context, *ring.trace, ring.camera(), settings);
    const char* const name = EnumNames<Kernel>::names[std::size_t(kernel)];
    const JudgedPicture& judged =
        set.pictures.emplace_back(judgedPicture(name, times.film.colour, converged));
    table.rows.push_back({name, 1000 / paper, times.clockMs, judged.psnr, judged.flip, times.primaryRaysMs});
  }
  context.add(std::move(table));
  context.add(std::move(set));
}

void benchIgpmLeaves(Context& context, const std::vector<IgpmScene>& scenes) {
  Table table = leavesTable();
  Plot plot{
      .id = "table1",
      .title = "Table 1: speed by the photons of a leaf, linear build",
      .caption =
          "As a part of each one's best speed. Here a tile asks for 64 samples at once, so that large leaves "
          "pay.",
      .x = {"photons of a leaf", true},
      .y = {"part of the best speed"}};
  for (const PhotonSplit split : {PhotonSplit::kMorton, PhotonSplit::kVolume})
    for (const IgpmScene& scene : scenes)
      if (context.hasTimeFor(fmt::format("table 1, {}, {}", scene.choice->name,
                                         split == PhotonSplit::kMorton ? "linear" : "volume"),
                             1))
        addLeaves(context, scene, split, table, plot);
  if (table.rows.empty()) return;
  context.add(std::move(table));
  context.add(std::move(plot));
}

}  // namespace isophote::bench
