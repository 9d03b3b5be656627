// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// How far every estimator's picture is from the path tracer's, and what another radius would change.
#include "app/bench/estimators_parts.h"
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/reference.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace isophote::bench {
namespace {

constexpr std::uint32_t kWidth = 320, kHeight = 180, kPhotons = 200'000;
/// Memory is told of a larger picture: lists of tiles grow with it.
constexpr std::uint32_t kMemoryWidth = 640, kMemoryHeight = 360;
constexpr WantedScene kMemoryScene{"atrium"};

constexpr std::array kRadiusScenes{WantedScene{"cornell-box"},
                                   WantedScene{"cornell-objects"},
                                   WantedScene{"colour-bleed"},
                                   WantedScene{"atrium"},
                                   kDabrovic,
                                   WantedScene{"Sponza (Crytek's)", PublicScene::kSponzaCrytek},
                                   WantedScene{"Sibenik", PublicScene::kSibenik},
                                   WantedScene{"Conference", PublicScene::kConference}};
constexpr double kForCost = 3;  ///< Seconds of a budget that radii leave to what is measured after them.
constexpr std::array kRadii{0.5, 0.7, 1.0, 1.4, 2.0};
constexpr std::size_t kAutomatic = 2;  ///< In kRadii.

std::uint32_t referencePaths(const Context& context) { return context.quick() ? 32 : 256; }

/// Everything at its default, one sample through the centre of each pixel. Direct light is not judged, so
/// that it costs as little as it can.
RenderSettings judgedSettings(const Context& context, Estimator estimator, std::uint32_t width,
                              std::uint32_t height) {
  RenderSettings settings;
  settings.frame.estimator = estimator;
  settings.photonTrace.photons = context.photons(kPhotons);
  settings.direct.areaSamples = 1;
  context.setSize(settings.frame, width, height);
  return settings;
}

struct Judgement {
  double radius = 0;  ///< The automatic one, or as set [m].
  double mean = 1;    ///< Over the path tracer's.
  double psnr = 0;    ///< Of the indirect light as displayed [dB].
};

Judgement judge(Context& context, EstimatorScene& scene, const RenderSettings& settings) {
  Stats stats;
  const Film film = renderCpu(scene.trace(), scene.camera(), settings, stats, context.job());
  const Comparison comparison = compareImages(film.layers.at("indirect"), scene.reference(settings.frame));
  return {stats.counter("radiusMetres"), comparison.meanRatio, comparison.psnr};
}

/// Three decimals, of means near 1.
Cell meanCell(double mean) { return Cell(mean, mean < 1 ? 3 : 4); }

double megabytesOf(Context& context, EstimatorScene& scene, Estimator estimator) {
  Stats stats;
  renderCpu(scene.trace(), scene.camera(), judgedSettings(context, estimator, kMemoryWidth, kMemoryHeight),
            stats, context.job());
  return estimateMegabytes(stats);
}

std::string sizesOf(const Context& context) {
  FrameSettings frame;
  context.setSize(frame, kWidth, kHeight);
  return fmt::format("{} x {} pixels, {} k photons, {} paths a pixel, all through pixels' centres",
                     frame.width, frame.height, context.photons(kPhotons) / 1000.0, referencePaths(context));
}

/// Cells of one row an estimator; each column that is added must fill all.
struct EstimatorTable {
  Table table;

  EstimatorTable() {
    for (const std::string_view name : EnumNames<Estimator>::names) table.rows.push_back({std::string(name)});
  }
  void addColumns(std::initializer_list<Column> columns) {
    table.columns.insert(table.columns.end(), columns);
    for (auto& row : table.rows) row.resize(table.columns.size());
  }
};

}  // namespace

EstimatorScene::EstimatorScene(Context& context, SceneChoice choice)
    : context_(context), choice_(std::move(choice)) {
  Stats stats;
  trace_ = buildTrace(choice_.scene, stats, context.job());
}

const Image& EstimatorScene::reference(const FrameSettings& frame) {
  if (!reference_) {
    ReferenceSettings settings;
    settings.width = frame.width;
    settings.height = frame.height;
    settings.bounces = frame.bounces;
    settings.spp = referencePaths(context_);
    settings.aa = 1;
    settings.indirectOnly = true;
    Stats stats;
    reference_ = renderReference(choice_.scene, camera(), settings, stats, context_.job()).colour;
  }
  return *reference_;
}

EstimatorScene* EstimatorScenes::find(const WantedScene& wanted) {
  const auto [found, isNew] = scenes_.try_emplace(wanted.name);
  if (!isNew) return found->second.get();
  SceneChoice choice = wanted.file
                           ? choosePublicScene(*wanted.file, context_.options().assetFolders, context_.job())
                           : context_.scene(std::string(wanted.name));
  if (choice.standsIn)
    context_.note(
        "Rows and columns of public scenes that are not at hand are left out. Name the folder of the public "
        "scenes with --assets or in ISOPHOTE_ASSETS.");
  else
    found->second = std::make_unique<EstimatorScene>(context_, std::move(choice));
  return found->second.get();
}

void benchBesidePathTracer(Context& context, EstimatorScenes& scenes) {
  EstimatorTable all;
  Table& table = all.table;
  table.id = "path-tracer";
  table.title = "Beside the path tracer";
  table.caption = fmt::format(
      "Indirect light alone: its mean over the path tracer's, and PSNR as displayed. {}; everything at its "
      "default, with the automatic radius (of kdtree the largest, of bvh the middle one). "
      "Memory: lists, hierarchies, copies of the photons and what is blurred, without the photons; {}.",
      sizesOf(context), kMemoryScene.name);
  all.addColumns({{"estimator"}});
  for (const WantedScene& wanted : kEstimatorScenes) {
    if (!context.hasTimeFor(fmt::format("estimators beside the path tracer, {}", wanted.name), 1)) continue;
    EstimatorScene* const scene = scenes.find(wanted);
    if (!scene) continue;
    const std::size_t first = table.columns.size();
    all.addColumns({{fmt::format("{}, radius", wanted.name), Source::kHere, "m"},
                    {fmt::format("{}, mean", wanted.name), Source::kHere},
                    {fmt::format("{}, PSNR", wanted.name), Source::kHere, "dB"}});
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const Judgement judged = judge(context, *scene, judgedSettings(context, Estimator(i), kWidth, kHeight));
      table.rows[i][first] = judged.radius;
      table.rows[i][first + 1] = meanCell(judged.mean);
      table.rows[i][first + 2] = judged.psnr;
    }
  }
  FrameSettings frame;
  context.setSize(frame, kMemoryWidth, kMemoryHeight);
  if (context.hasTimeFor("memory of estimates", 0.5)) {
    all.addColumns({{fmt::format("memory, {} x {}", frame.width, frame.height), Source::kHere, "MB"}});
    for (std::size_t i = 0; i < table.rows.size(); ++i)
      table.rows[i].back() = megabytesOf(context, *scenes.find(kMemoryScene), Estimator(i));
  }
  context.add(std::move(table));
}

void benchAutomaticRadius(Context& context, EstimatorScenes& scenes) {
  const Estimator usual = RenderSettings().frame.estimator;
  Table table{.id = "automatic-radius",
              .title = "The automatic radius beside others",
              .caption = fmt::format(
                  "PSNR of the indirect light beside the path tracer's at so many times the automatic "
                  "radius, by {}; {}. Last: what the best of these radii is better by, and the mean over the "
                  "path tracer's at the automatic one.",
                  EnumNames<Estimator>::names[std::size_t(usual)], sizesOf(context)),
              .columns = {{"scene"}, {"automatic radius", Source::kHere, "m"}}};
  for (const double part : kRadii) table.columns.push_back({fmt::format("x {}", part), Source::kHere, "dB"});
  table.columns.push_back({"best over x 1", Source::kHere, "dB"});
  table.columns.push_back({"mean", Source::kHere});
  for (const WantedScene& wanted : kRadiusScenes) {
    if (!context.hasTimeFor(fmt::format("the automatic radius, {}", wanted.name), kForCost)) continue;
    EstimatorScene* const scene = scenes.find(wanted);
    if (!scene) continue;
    RenderSettings settings = judgedSettings(context, usual, kWidth, kHeight);
    const Judgement automatic = judge(context, *scene, settings);
    std::array<double, kRadii.size()> psnr{};
    for (std::size_t i = 0; i < kRadii.size(); ++i) {
      setRadius(settings, usual, automatic.radius * kRadii[i]);
      psnr[i] = i == kAutomatic ? automatic.psnr : judge(context, *scene, settings).psnr;
    }
    std::vector<Cell> row{wanted.name, automatic.radius};
    row.insert(row.end(), psnr.begin(), psnr.end());
    row.emplace_back(*std::ranges::max_element(psnr) - automatic.psnr, 2);
    row.push_back(meanCell(automatic.mean));
    table.rows.push_back(std::move(row));
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

}  // namespace isophote::bench
