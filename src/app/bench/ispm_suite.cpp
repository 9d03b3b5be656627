// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What the paper on image space photon mapping measured (McGuire and Luebke 2009): frames, table 2 and figure
// 10. Its other tables and figures are in ispm_quality.cpp and ispm_scaling.cpp.
#include "app/bench/frames.h"
#include "app/bench/ispm_parts.h"
#include "render/test_ring.h"

#include <fmt/format.h>

#include <array>
#include <optional>

namespace isophote::bench {
namespace {

/// As table 2 prints it, times in milliseconds.
struct PaperRow {
  const char* name;
  IspmSetUp setUp;
  double hits, stored;
  double direct, copies, trace, estimate;
  double framesPerSecond;
};

/// The rows of one of the paper's scenes, and the scene that is measured for them.
struct PaperScene {
  SceneChoice (*choose)(Context& context);
  std::vector<PaperRow> rows;
};

SceneChoice sponza(Context& context) { return context.scene(PublicScene::kSponzaDabrovic); }
SceneChoice level(Context& context) { return context.scene(PublicScene::kLevel); }
SceneChoice ring(Context&) { return {spottedRing(), "caustic-ring under a spot", false}; }
SceneChoice glassSphere(Context&) {
  return {underPointLight("glass-sphere", {0, 1.5f, 0.3f}, 25), "glass-sphere under a point light", false};
}
SceneChoice objects(Context&) {
  return {underPointLight("cornell-objects", {0, 1.7f, 0.3f}, 25), "cornell-objects under a point light",
          false};
}

const std::vector<PaperScene>& paperScenes() {
  static const std::vector<PaperScene> scenes{
      {sponza,
       {{"Sponza Atrium", {1920, 1600, 13'688, 1, 4}, 23'244, 11'308, 8.8, 8.4, 56.7, 12.9, 11.9},
        {"Sponza Atrium", kIspmSponza, 10'573, 5'136, 8.8, 5.4, 28.2, 7.2, 22.4}}},
      {ring,
       {{"Caustic Ring", {512, 384, 101'124, 1, 1}, 27'917, 5'020, 1.4, 21.3, 6.4, 3.4, 28},
        {"Caustic Ring", {512, 384, 324'900, 1, 1}, 89'919, 16'030, 1.4, 63.5, 20.1, 9.6, 10.9},
        {"Caustic Ring", {1920, 1080, 101'124, 1, 1}, 27'917, 5'020, 7.6, 22.1, 7.3, 14.3, 24.3}}},
      {glassSphere,
       {{"Glass Sphere", {512, 512, 26'640, 2, 6}, 19'343, 10'941, 2.2, 9.8, 8.9, 3.8, 38.8},
        {"Glass Sphere", {512, 512, 137'780, 3, 3}, 108'569, 66'447, 2.5, 36.1, 31.0, 21.4, 10.3},
        {"Glass Sphere", {1920, 1080, 18'000, 2, 6}, 12'935, 7'319, 9.0, 7.6, 4.0, 11.3, 34.1}}},
      {objects,
       {{"Objects in Box", {1920, 1080, 27'620, 3, 8}, 58'965, 37'433, 8.2, 16.6, 22.8, 40.1, 11.8},
        {"Objects in Box", {1920, 1080, 27'620, 2, 10}, 52'047, 30'515, 8.3, 16.1, 17.2, 23.2, 15.8}}},
      {level, {{"NS2, full map", {1920, 1080, 95'948, 3, 6}, 97'982, 61'000, 150.2, 67, 284.4, 14.5, 2.0}}},
  };
  return scenes;
}

Table emptyTable() {
  return {
      .id = "table2",
      .title = "Table 2: frames of --preset ispm",
      .caption =
          "Paper: McGuire and Luebke 2009, two quad-core Intel Extreme of 3.2 GHz, which trace, and a "
          "GeForce "
          "GTX 280, which does all else. Its scenes are not at hand but for Sponza, whose lamp, albedos and "
          "radii are not printed; the game levels Ironworks and the glass bunny have no counterpart here. "
          "\"direct\" is everything of direct light: first surfaces, shadow maps, shading, composite; "
          "\"trace\" is bounce maps, tracing and the radius; \"estimate\" is photon volumes and upsampling. "
          "The "
          "yardstick is Embree alone on the frame's primary rays.",
      .columns = {{"the paper's scene"},
                  {"measured"},
                  {"size"},
                  {"cells"},
                  {"emitted", Source::kHere},
                  {"stored", Source::kPaper},
                  {"stored", Source::kHere},
                  {"direct", Source::kPaper, "ms"},
                  {"direct", Source::kHere, "ms"},
                  {"trace", Source::kPaper, "ms"},
                  {"trace", Source::kHere, "ms"},
                  {"copies", Source::kPaper, "ms"},
                  {"estimate", Source::kPaper, "ms"},
                  {"estimate", Source::kHere, "ms"},
                  {"frame", Source::kPaper, "ms"},
                  {"frame", Source::kHere, "ms"},
                  {"processor", Source::kHere, "ms"},
                  {"primary rays", Source::kYardstick, "ms"},
                  {"frame over them", Source::kYardstick}}};
}

std::vector<Cell> rowOf(const PaperRow& paper, const SceneChoice& scene, const RenderSettings& settings,
                        const FrameTimes& times) {
  const FrameSettings& frame = settings.frame;
  return {paper.name,
          scene.name,
          fmt::format("{} x {}", frame.width, frame.height),
          fmt::format("{0} x {0}", frame.subsample),
          times.last.counter("photonsEmitted"),
          paper.stored,
          times.last.counter("photonsStored"),
          paper.direct,
          times.stagesMedian({"gbuffer", "direct", "direct.shadow_maps", "composite"}),
          paper.trace,
          times.stagesMedian({"light_gbuffer", "bounce_map", "photon_trace", "photon_trace.radius"}),
          paper.copies,
          paper.estimate,
          times.stagesMedian({"photon_volumes", "upsample", "upsample.choose"}),
          1000 / paper.framesPerSecond,
          times.clockMs,
          times.processorMs,
          times.primaryRaysMs,
          times.overPrimaryRays()};
}

/// Figure 10: what part of the emitted photons meets a surface after so many events.
struct Attrition {
  Plot plot{.id = "figure10",
            .title = "Figure 10: photons that are left",
            .caption =
                "Surface hits after 0, 1, 2 and 3 events, as a part of the photons emitted; bounce maps deal "
                "with the first.",
            .x = {""},
            .y = {"hits over photons emitted"}};
  Table table{.id = "figure10",
              .title = "Figure 10: photon attrition",
              .caption =
                  "Hits of all bounces and photons stored, of each photon emitted; the paper's follow from "
                  "its table 2.",
              .columns = {{"measured"},
                          {"bounces"},
                          {"hits", Source::kPaper},
                          {"hits", Source::kHere},
                          {"stored", Source::kPaper},
                          {"stored", Source::kHere},
                          {"first hits", Source::kHere},
                          {"after one event", Source::kHere},
                          {"after two", Source::kHere},
                          {"after three", Source::kHere}}};

  void add(const PaperRow& paper, const SceneChoice& scene, const Stats& stats) {
    const double emitted = std::max(stats.counter("photonsEmitted"), 1.0);
    const std::vector<double> hits = stats.counterList("hitsPerBounce");
    double all = 0;
    for (const double count : hits) all += count;
    std::vector<Cell> row{
        scene.name,    std::to_string(paper.setUp.bounces), paper.hits / paper.setUp.photons,
        all / emitted, paper.stored / paper.setUp.photons,  stats.counter("photonsStored") / emitted};
    for (std::size_t i = 0; i < 4; ++i) row.push_back(i < hits.size() ? Cell(hits[i] / emitted) : Cell());
    table.rows.push_back(std::move(row));
    // A group of bars a scene, of the row with the most bounces that comes first.
    const std::string name = scene.scene.name;
    if (!plot.categories.empty() && plot.categories.back() == name) return;
    plot.categories.push_back(name);
    for (std::size_t i = 0; i < hits.size() && i < 4; ++i) {
      if (plot.series.size() <= i)
        plot.series.push_back({.name = i == 1 ? "after one event" : fmt::format("after {} events", i)});
      plot.series[i].points.emplace_back(double(plot.categories.size() - 1), hits[i] / emitted);
    }
  }
};

void runIspm(Context& context) {
  benchIspmFrames(context);
  benchIspmUpsampling(context);
  benchIspmScaling(context);
  benchIspmCulling(context);
  benchIspmQuality(context);
}

}  // namespace

RenderSettings ispmSettings(const Context& context, const IspmSetUp& setUp) {
  RenderSettings settings = presetSettings("ispm");
  context.setSize(settings.frame, setUp.width, setUp.height);
  settings.frame.layers = false;
  settings.frame.bounces = setUp.bounces;
  settings.frame.subsample = setUp.subsample;
  settings.photonTrace.photons = context.photons(setUp.photons);
  settings.direct.shadowResolution = context.side(settings.direct.shadowResolution);
  return settings;
}

void benchIspmFrames(Context& context) {
  Table table = emptyTable();
  Attrition attrition;
  for (const PaperScene& paper : paperScenes()) {
    std::optional<SceneChoice> scene;
    std::optional<TraceScene> trace;
    for (const PaperRow& row : paper.rows) {
      if (!context.hasTimeFor(
              fmt::format("table 2, {} at {} x {}", row.name, row.setUp.width, row.setUp.height)))
        continue;
      if (!scene) {
        scene = paper.choose(context);
        trace.emplace(scene->scene);
      }
      const RenderSettings settings = ispmSettings(context, row.setUp);
      const FrameTimes times = measureFrames(context, *trace, scene->scene.cameras.front(), settings);
      table.rows.push_back(rowOf(row, *scene, settings, times));
      attrition.add(row, *scene, times.last);
    }
  }
  context.add(std::move(table));
  context.add(std::move(attrition.table));
  context.add(std::move(attrition.plot));
}

const Suite kIspmSuite{"ispm", "Image space photon mapping: frames, upsampling, culling, scaling", 11,
                       runIspm};

}  // namespace isophote::bench
