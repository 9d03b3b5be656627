// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// ISPM: what subsampling costs the picture (figure 12), what culling leaves out (figure 9), and how a frame
// compares with gathering the same photons (table 3).
#include "app/bench/frames.h"
#include "app/bench/ispm_parts.h"
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/test_ring.h"

#include <fmt/format.h>

#include <array>

namespace isophote::bench {
namespace {

Image indirectOf(const Film& film) { return film.layers.at("indirect"); }

/// A row of figure 9.
struct Culling {
  const char* name;
  float distance, lights;
  double paperFramesPerSecond;  ///< 0: none.
};
constexpr std::array kCullings{Culling{"all lights", 0, 0, 2.0}, Culling{"cull.distance=14", 14, 0, 15.2},
                               Culling{"cull.distance=8", 8, 0, 21.4},
                               Culling{"cull.lights=0.05", 0, 0.05f, 0}};

Table cullingTable(const SceneChoice& scene, const RenderSettings& settings) {
  return {.id = "figure9",
          .title = "Figure 9: culling lights",
          .caption = fmt::format("{}, {} x {}, {} photons if no light is left out. Paper: 30 lights of the "
                                 "level NS2, culled with the "
                                 "objects to a circle, and to the room that is seen. The picture is compared "
                                 "with that of all lights.",
                                 scene.name, settings.frame.width, settings.frame.height,
                                 settings.photonTrace.photons),
          .columns = {{"left out"},
                      {"lights left", Source::kHere},
                      {"emitted", Source::kHere},
                      {"frame", Source::kPaper, "ms"},
                      {"frame", Source::kHere, "ms"},
                      {"times faster", Source::kPaper},
                      {"times faster", Source::kHere},
                      {"mean of the picture", Source::kHere},
                      {"PSNR", Source::kHere, "dB"},
                      {"primary rays", Source::kYardstick, "ms"}}};
}

/// A row of table 3.
struct Rival {
  const char* name;
  SceneChoice (*choose)(Context& context);
  IspmSetUp setUp;
  const char* method;
  double rivalMs, ispmMs;
};

SceneChoice ring(Context&) { return {spottedRing(), "caustic-ring under a spot", false}; }
SceneChoice box(Context&) {
  return {underPointLight("cornell-box", {0, 1.8f, 0}, 25), "cornell-box under a point light", false};
}
SceneChoice sponza(Context& context) { return context.scene(PublicScene::kSponzaDabrovic); }

/// The paper prints no photons for the box: those that 512 x 512 pixels had elsewhere in it.
constexpr std::array kRivals{
    Rival{"Ring 512 x 384", ring, {512, 384, 101'124, 1, 1}, "photon mapping (Purcell 2003)", 639, 36},
    Rival{"Box 512 x 512", box, {512, 512, 26'640, 2, 6}, "photon mapping (Purcell 2003)", 3721, 26},
    Rival{"Sponza 1920 x 1600",
          sponza,
          {1920, 1600, 13'688, 1, 4},
          "imperfect shadow maps (Ritschel 2008)",
          166,
          84}};

Table rivalTable() {
  return {
      .id = "table3",
      .title = "Table 3: against gathering",
      .caption =
          "Paper: times of others for pictures of similar quality, adjusted by the fill rates of the "
          "graphics "
          "processors. Here: the same photons gathered by the 100 nearest in a kd-tree, with traced shadows "
          "(--preset jensen), and PSNR of both beside many passes of photons. Imperfect shadow maps are not "
          "implemented; the kd-tree stands for them too.",
      .columns = {{"the paper's row"},
                  {"measured"},
                  {"method of the other"},
                  {"the other", Source::kPaper, "ms"},
                  {"ISPM", Source::kPaper, "ms"},
                  {"times faster", Source::kPaper},
                  {"kd-tree", Source::kHere, "ms"},
                  {"ISPM", Source::kHere, "ms"},
                  {"times faster", Source::kHere},
                  {"kd-tree", Source::kHere, "dB"},
                  {"ISPM", Source::kHere, "dB"},
                  {"primary rays", Source::kYardstick, "ms"}}};
}

void addRival(Context& context, const Rival& rival, Table& table) {
  const SceneChoice scene = rival.choose(context);
  const TraceScene trace(scene.scene);
  const Camera& camera = scene.scene.cameras.front();
  const RenderSettings settings = ispmSettings(context, rival.setUp);
  RenderSettings gathered = presetSettings("jensen");
  gathered.frame.width = settings.frame.width;
  gathered.frame.height = settings.frame.height;
  gathered.frame.bounces = settings.frame.bounces;
  gathered.photonTrace.photons = settings.photonTrace.photons;
  const FrameTimes ours = measureFrames(context, trace, camera, settings);
  const FrameTimes nearest = measureFrames(context, trace, camera, gathered, 2);
  const Image converged = convergedByPhotons(context, trace, camera, settings, context.photons(200'000),
                                             context.quick() ? 4 : 24);
  PictureSet set{.id = fmt::format("table3-{}", table.rows.size()),
                 .title = fmt::format("{}: image space photon mapping and gathering", scene.name),
                 .caption = "The same photons, one frame each, beside many passes.",
                 .reference = shownPicture("many passes", converged)};
  set.pictures = {judgedPicture("ISPM", ours.film.colour, converged),
                  judgedPicture("100 nearest", nearest.film.colour, converged)};
  table.rows.push_back({rival.name, scene.name, rival.method, rival.rivalMs, rival.ispmMs,
                        rival.rivalMs / rival.ispmMs, nearest.clockMs, ours.clockMs,
                        nearest.clockMs.median() / ours.clockMs.median(), set.pictures[1].psnr,
                        set.pictures[0].psnr, ours.primaryRaysMs});
  context.add(std::move(set));
}

}  // namespace

void benchIspmUpsampling(Context& context) {
  if (!context.hasTimeFor("figure 12, upsampling", 1)) return;
  constexpr std::uint32_t kCells = 16;
  const SceneChoice scene = context.scene(PublicScene::kSponzaDabrovic);
  const TraceScene trace(scene.scene);
  const Camera& camera = scene.scene.cameras.front();
  RenderSettings settings = ispmSettings(context, {960, 540, 50'000, 1, 1});
  settings.frame.layers = true;
  Stats stats;
  const Image full = indirectOf(renderCpu(trace, camera, settings, stats, context.job()));
  const double fullMs = stats.stageMilliseconds("photon_volumes");
  const DisplayOptions display{.exposureEv = autoExposureEv(full)};
  Table table{.id = "figure12",
              .title = fmt::format("Figure 12: indirect light of one sample for {0} x {0} pixels", kCells),
              .caption = fmt::format(
                  "{}, {} x {}, beside the estimate at every pixel, which took {:.0f} ms. The paper shows "
                  "pictures, no figures.",
                  scene.name, settings.frame.width, settings.frame.height, fullMs),
              .columns = {{"weights"},
                          {"estimate and upsampling", Source::kHere, "ms"},
                          {"relative squared error", Source::kHere},
                          {"PSNR", Source::kHere, "dB"},
                          {"FLIP", Source::kHere},
                          {"mean", Source::kHere}}};
  PictureSet set{.id = "figure12",
                 .title = table.title,
                 .caption = "Each weight is added to those before: place on the screen, normals, depth.",
                 .reference = shownPicture("every pixel", full, display)};
  settings.frame.subsample = kCells;
  for (const auto weights : {UpsampleWeights::kNearest, UpsampleWeights::kBilinear, UpsampleWeights::kNormal,
                             UpsampleWeights::kDepth}) {
    settings.upsample.weights = weights;
    Stats part;
    const Image picture = indirectOf(renderCpu(trace, camera, settings, part, context.job()));
    const Comparison comparison = compareImages(picture, full, {.display = display});
    const char* const name = EnumNames<UpsampleWeights>::names[std::size_t(weights)];
    table.rows.push_back({name,
                          part.stageMilliseconds("photon_volumes") + part.stageMilliseconds("upsample") +
                              part.stageMilliseconds("upsample.choose"),
                          Cell(comparison.relMse), comparison.psnr, comparison.flip,
                          Cell(comparison.meanRatio, 4)});
    set.pictures.push_back(judgedPicture(name, picture, full, display));
  }
  context.add(std::move(table));
  context.add(std::move(set));
}

void benchIspmCulling(Context& context) {
  if (!context.hasTimeFor("figure 9, culling", 2)) return;
  const SceneChoice scene = context.scene(PublicScene::kLevel);
  const TraceScene trace(scene.scene);
  const Camera& camera = scene.scene.cameras.front();
  RenderSettings settings = ispmSettings(context, {1920, 1080, 95'948, 3, 6});
  settings.direct.shadowResolution = context.side(256);
  Table table = cullingTable(scene, settings);
  PictureSet set{.id = "figure9", .title = table.title, .caption = "Beside the frame with all lights."};
  Image all;
  double allMs = 0;
  for (const Culling& culling : kCullings) {
    settings.cull.distance = culling.distance;
    settings.cull.lights = culling.lights;
    const FrameTimes times = measureFrames(context, trace, camera, settings);
    const Image& picture = times.film.colour;
    if (table.rows.empty()) {
      all = picture;
      allMs = times.clockMs.median();
      set.reference = shownPicture(culling.name, all);
    }
    const Comparison comparison = compareImages(picture, all);
    const double paper = culling.paperFramesPerSecond, full = kCullings.front().paperFramesPerSecond;
    table.rows.push_back(
        {culling.name, double(scene.scene.lights.size()) - times.last.counter("cull.lightsLeftOut"),
         times.last.counter("photonsEmitted"), paper > 0 ? Cell(1000 / paper) : Cell(), times.clockMs,
         paper > 0 ? Cell(paper / full) : Cell(), allMs / times.clockMs.median(), comparison.meanRatio,
         table.rows.empty() ? Cell() : Cell(comparison.psnr), times.primaryRaysMs});
    if (table.rows.size() > 1) set.pictures.push_back(judgedPicture(culling.name, picture, all));
  }
  context.add(std::move(table));
  context.add(std::move(set));
}

void benchIspmQuality(Context& context) {
  Table table = rivalTable();
  for (const Rival& rival : kRivals)
    if (context.hasTimeFor(fmt::format("table 3, {}", rival.name), 2)) addRival(context, rival, table);
  if (!table.rows.empty()) context.add(std::move(table));
}

}  // namespace isophote::bench
