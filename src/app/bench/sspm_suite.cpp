// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The tables of the thesis on soft shadows with image space photon mapping (Yao 2010): what soft shadows add
// to a frame, and photon quads beside the icosahedra that they took the place of.
#include "app/bench/frames.h"
#include "app/bench/suite.h"
#include "render/cpu_renderer.h"
#include "scene/builtin/shapes.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <utility>

namespace isophote::bench {
namespace {

constexpr const char* kHardware =
    "The thesis: Core i7 930 at 2.8 GHz, GeForce GTX 480, 1024 x 768 pixels. Its photons' radii are in units "
    "that "
    "it does not tell, so ours are automatic";

/// The scenes of the thesis.
enum class ThesisScene { kCornellBox, kBuddha, kDragon, kGlassSphere, kGlassBunny, kSibenik, kSponza };

struct ThesisRow {
  ThesisScene scene;
  const char* name;
  std::uint32_t subsample, bounces, photons;
  std::uint32_t blurSamples;  ///< Of the second pass, 5 x 5 or 7 x 7; the first has 4 x 4.
  double softFps, hardFps;
  bool quick;  ///< Measured with --quick too.
};

constexpr std::array kTable1{
    ThesisRow{ThesisScene::kCornellBox, "Cornell box", 8, 1, 10'000, 25, 32, 107, false},
    ThesisRow{ThesisScene::kCornellBox, "Cornell box", 8, 2, 20'000, 25, 27, 85, true},
    ThesisRow{ThesisScene::kBuddha, "Happy buddha", 4, 1, 10'000, 25, 20, 40, false},
    ThesisRow{ThesisScene::kDragon, "Chinese dragon", 4, 3, 30'000, 25, 23, 35, false},
    ThesisRow{ThesisScene::kGlassSphere, "Glass sphere", 4, 2, 20'000, 25, 34, 70, true},
    ThesisRow{ThesisScene::kGlassBunny, "Glass bunny", 4, 2, 20'000, 25, 32, 63, false},
    ThesisRow{ThesisScene::kSibenik, "Sibenik", 2, 2, 20'000, 49, 12, 35, false},
    ThesisRow{ThesisScene::kSponza, "Sponza Atrium", 2, 2, 20'000, 49, 9, 20, true},
};

struct QuadRow {
  ThesisScene scene;
  const char* name;
  std::uint32_t bounces, photons;
  double quadFps, quadHardFps, icosahedronFps, icosahedronHardFps;
  bool quick;
};

constexpr std::array kTable2{
    QuadRow{ThesisScene::kCornellBox, "Cornell box", 2, 20'000, 22.0, 61.0, 21.0, 60.7, false},
    QuadRow{ThesisScene::kCornellBox, "Cornell box", 3, 30'000, 23.0, 61.4, 20.4, 54.0, true},
    QuadRow{ThesisScene::kBuddha, "Happy buddha", 3, 30'000, 11.7, 42.1, 11.3, 37.2, false},
    QuadRow{ThesisScene::kDragon, "Chinese dragon", 3, 30'000, 21.2, 56.3, 20.5, 50.9, false},
    QuadRow{ThesisScene::kGlassBunny, "Glass bunny", 3, 30'000, 22.0, 60.3, 20.6, 51.4, false},
    QuadRow{ThesisScene::kSibenik, "Sibenik", 3, 30'000, 22.0, 43.0, 18.9, 33.0, false},
    QuadRow{ThesisScene::kSponza, "Sponza Atrium", 3, 30'000, 27.5, 46.4, 24.7, 39.5, true},
};

std::string modelFile(const Options& options, const char* model) {
  for (const std::filesystem::path& folder : options.assetFolders) {
    std::error_code ignored;
    if (std::filesystem::exists(folder / model, ignored)) return (folder / model).string();
  }
  return {};
}

/// The room of colour-bleed without what stands in it, and a model in its middle, 1.3 m high.
Scene roomWith(const std::string& file, const NamedMaterial& material, const Job& job) {
  Scene room = loadScene("colour-bleed", {}, job);
  room.instances.resize(room.instances.size() - 2);
  Job quiet = job;
  quiet.log = nullptr;  // A model has no lights, and no need of any.
  const Scene model = loadScene(file, {}, quiet);
  const vec3 size = model.bounds.size(), centre = model.bounds.centre();
  const float scale = std::min(1.3f / size.y, 1.8f / std::max(size.x, size.z));
  const vec3 move = vec3(0.0f, 0.0f, -0.7f) - vec3(centre.x, model.bounds.lower.y, centre.z) * scale;
  const mat4x3 place(vec3(scale, 0, 0), vec3(0, scale, 0), vec3(0, 0, scale), move);
  const std::uint32_t index = addMaterial(room, material);
  for (const Instance& instance : model.instances) {
    Mesh mesh = model.meshes[instance.mesh];
    transform(mesh, instance.worldFromObject);
    transform(mesh, place);
    mesh.tangents.clear();
    addObject(room, instance.name, index, std::move(mesh));
  }
  finishScene(room, file, job);
  return room;
}

NamedMaterial glass() {
  NamedMaterial material{makeMaterial(), "glass"};
  material.transmission = 1.0f;
  material.roughness = 0.0f;
  return material;
}

/// A model of the public scenes in the room, or what is built in.
SceneChoice modelInRoom(Context& context, const char* model, const char* name, const char* of, bool ofGlass,
                        const char* standIn) {
  const std::string file = modelFile(context.options(), model);
  if (!file.empty()) {
    const NamedMaterial material = ofGlass ? glass() : lambert("model", vec3(0.7f));
    return {roomWith(file, material, context.job()), fmt::format("{} in colour-bleed, for {}", name, of),
            true};
  }
  SceneChoice choice = context.scene(standIn);
  context.note(
      fmt::format("A model is not at hand, so that a built-in scene is measured: {}, for {}.", standIn, of));
  choice.name = fmt::format("{}, for {}", standIn, of);
  choice.standsIn = true;
  return choice;
}

/// Lamps with an area give way to a point in their place: soft shadows are those of the lamp's own size.
void underAPoint(SceneChoice& choice, const Job& job) {
  for (NamedMaterial& material : choice.scene.materials) material.emission = vec3(0.0f);
  Light lamp{};
  lamp.type = kLightPoint;
  const Bounds& bounds = choice.scene.bounds;
  lamp.position = bounds.centre() + vec3(0.0f, 0.4f * bounds.size().y, 0.0f);
  lamp.colour = vec3(0.6f * bounds.size().y * bounds.size().y);
  choice.scene.lights = {lamp};
  choice.scene.emissiveTriangles.clear();
  choice.scene.emissiveAliases.clear();
  finishScene(choice.scene, choice.name, job);
}

SceneChoice sceneOf(Context& context, ThesisScene wanted) {
  switch (wanted) {
    case ThesisScene::kCornellBox: {
      SceneChoice choice = context.scene("colour-bleed");
      choice.name = "colour-bleed, for the Cornell box";
      return choice;
    }
    case ThesisScene::kBuddha:
      return modelInRoom(context, "dragon/dragon_47k.obj", "dragon of 47 k", "Happy buddha", false,
                         "colour-bleed");
    case ThesisScene::kDragon:
      return modelInRoom(context, "dragon/dragon_47k.obj", "dragon of 47 k", "Chinese dragon", false,
                         "colour-bleed");
    case ThesisScene::kGlassBunny: {
      SceneChoice choice =
          modelInRoom(context, "bunny/bunny.obj", "bunny", "Glass bunny", true, "glass-sphere");
      if (!choice.scene.emissiveTriangles.empty()) underAPoint(choice, context.job());
      return choice;
    }
    case ThesisScene::kGlassSphere: {
      SceneChoice choice = context.scene("glass-sphere");
      choice.name = "glass-sphere under a point";
      underAPoint(choice, context.job());
      return choice;
    }
    case ThesisScene::kSibenik:
      return context.scene(PublicScene::kSibenik);
    case ThesisScene::kSponza:
      break;
  }
  return context.scene(PublicScene::kSponzaDabrovic);
}

double triangleCount(const Scene& scene) {
  double count = 0;
  for (const Instance& instance : scene.instances)
    count += double(scene.meshes[instance.mesh].triangles.size());
  return count;
}

RenderSettings thesisSettings(const Context& context, const Scene& scene, std::uint32_t subsample,
                              std::uint32_t bounces, std::uint32_t photons) {
  RenderSettings settings = presetSettings("sspm");
  context.setSize(settings.frame, 1024, 768);
  settings.frame.layers = false;
  settings.frame.subsample = subsample;
  settings.frame.bounces = bounces;
  settings.photonTrace.photons = context.photons(photons);
  settings.direct.lightRadius = 0.03f * scene.bounds.size().y;
  return settings;
}

RenderSettings withHardShadows(RenderSettings settings) {
  settings.direct.shadows = Shadows::kTraced;
  return settings;
}

void tableOfShadows(Context& context) {
  Table table{
      .id = "table1",
      .title = "Table 1: frames with soft shadows, and with hard ones",
      .caption = fmt::format("{}. Samples: of both passes of image space gathering. \"Hard\" are traced "
                             "shadows, with the thesis as here.",
                             kHardware),
      .columns = {{"scene of the thesis"},
                  {"measured"},
                  {"triangles"},
                  {"subsampling"},
                  {"bounces"},
                  {"photons"},
                  {"samples"},
                  {"soft", Source::kPaper, "frames/s"},
                  {"hard", Source::kPaper, "frames/s"},
                  {"soft/hard", Source::kPaper, "time"},
                  {"soft", Source::kHere, "ms"},
                  {"hard", Source::kHere, "ms"},
                  {"soft/hard", Source::kHere, "time"},
                  {"soft shadows", Source::kHere, "ms"},
                  {"hard shadows", Source::kHere, "ms"},
                  {"primary rays", Source::kYardstick, "ms"}}};
  for (const ThesisRow& row : kTable1) {
    if (context.quick() && !row.quick) continue;
    if (!context.hasTimeFor(fmt::format("table 1, {}", row.name))) continue;
    const SceneChoice choice = sceneOf(context, row.scene);
    const TraceScene trace(choice.scene);
    const Camera& camera = choice.scene.cameras.front();
    RenderSettings settings = thesisSettings(context, choice.scene, row.subsample, row.bounces, row.photons);
    settings.direct.blurSamples = row.blurSamples;
    const FrameTimes soft = measureFrames(context, trace, camera, settings);
    const FrameTimes hard = measureFrames(context, trace, camera, withHardShadows(settings));
    table.rows.push_back(
        {row.name, choice.name, Cell(triangleCount(choice.scene), 7), fmt::format("{0} x {0}", row.subsample),
         double(row.bounces), Cell(double(settings.photonTrace.photons), 6),
         row.blurSamples == 25 ? "4 x 4 + 5 x 5" : "4 x 4 + 7 x 7", row.softFps, row.hardFps,
         row.hardFps / row.softFps, soft.clockMs, hard.clockMs, soft.clockMs.median() / hard.clockMs.median(),
         soft.stage("direct"), hard.stage("direct"), soft.primaryRaysMs});
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

/// Photons as quads, without icosahedra in corners, or as icosahedra that are not flattened: as the thesis
/// has them.
RenderSettings withEstimator(RenderSettings settings, Estimator estimator) {
  settings.frame.estimator = estimator;
  settings.photonVolumes.flatness = 1.0f;
  settings.photonQuads.corners = false;
  return settings;
}

void tableOfQuads(Context& context) {
  Table table{.id = "table2",
              .title = "Table 2: photon quads and icosahedra",
              .caption = fmt::format(
                  "{}. All with soft shadows and 8 x 8 subsampling; \"hard\" of the thesis is with "
                  "hard ones. Ratios are icosahedra over quads, of frames (thesis: soft, hard) and of "
                  "the estimate alone. Pairs: a photon and a view sample that were compared, and "
                  "those in which light arrived.",
                  kHardware),
              .columns = {{"scene of the thesis"},
                          {"measured"},
                          {"bounces"},
                          {"photons"},
                          {"quads", Source::kPaper, "frames/s"},
                          {"icosahedra", Source::kPaper, "frames/s"},
                          {"soft", Source::kPaper, "ratio"},
                          {"hard", Source::kPaper, "ratio"},
                          {"quads", Source::kHere, "ms"},
                          {"icosahedra", Source::kHere, "ms"},
                          {"frames", Source::kHere, "ratio"},
                          {"estimate, quads", Source::kHere, "ms"},
                          {"estimate, icosahedra", Source::kHere, "ms"},
                          {"estimates", Source::kHere, "ratio"},
                          {"pairs, quads", Source::kHere, "M"},
                          {"lit, quads", Source::kHere, "M"},
                          {"pairs, icosahedra", Source::kHere, "M"},
                          {"lit, icosahedra", Source::kHere, "M"},
                          {"primary rays", Source::kYardstick, "ms"}}};
  for (const QuadRow& row : kTable2) {
    if (context.quick() && !row.quick) continue;
    if (!context.hasTimeFor(fmt::format("table 2, {}", row.name))) continue;
    const SceneChoice choice = sceneOf(context, row.scene);
    const TraceScene trace(choice.scene);
    const Camera& camera = choice.scene.cameras.front();
    const RenderSettings settings = thesisSettings(context, choice.scene, 8, row.bounces, row.photons);
    const FrameTimes quads =
        measureFrames(context, trace, camera, withEstimator(settings, Estimator::kQuads));
    const FrameTimes solid =
        measureFrames(context, trace, camera, withEstimator(settings, Estimator::kVolumes));
    const auto millions = [](const FrameTimes& frame, const char* counter) {
      return frame.last.counter(counter) * 1e-6;
    };
    table.rows.push_back({row.name, choice.name, double(row.bounces),
                          Cell(double(settings.photonTrace.photons), 6), row.quadFps, row.icosahedronFps,
                          row.quadFps / row.icosahedronFps, row.quadHardFps / row.icosahedronHardFps,
                          quads.clockMs, solid.clockMs, solid.clockMs.median() / quads.clockMs.median(),
                          quads.stage("photon_quads"), solid.stage("photon_volumes"),
                          solid.stage("photon_volumes").median() / quads.stage("photon_quads").median(),
                          millions(quads, "photon_quads.pairsTested"),
                          millions(quads, "photon_quads.pairsContributing"),
                          millions(solid, "photon_volumes.pairsTested"),
                          millions(solid, "photon_volumes.pairsContributing"), quads.primaryRaysMs});
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

/// The thesis says that quads win by more as photons grow, from 30 k on.
void plotOfPhotons(Context& context) {
  if (!context.hasTimeFor("the plot over photons")) return;
  const SceneChoice choice = sceneOf(context, ThesisScene::kCornellBox);
  const TraceScene trace(choice.scene);
  Plot plot{.id = "photons",
            .title = "The estimate over photons, Cornell box, 8 x 8 subsampling",
            .caption = fmt::format("{}, two bounces.", choice.name),
            .x = {"photons"},
            .y = {"estimate [ms]"}};
  Series quads{.name = "quads"}, solid{.name = "icosahedra"};
  for (const std::uint32_t photons : {10'000u, 20'000u, 30'000u, 40'000u, 60'000u}) {
    if (context.quick() && photons % 30'000u != 0) continue;
    const RenderSettings settings = thesisSettings(context, choice.scene, 8, 2, photons);
    const double x = double(settings.photonTrace.photons);
    const Camera& camera = choice.scene.cameras.front();
    quads.points.emplace_back(
        x, measureFrames(context, trace, camera, withEstimator(settings, Estimator::kQuads))
               .stage("photon_quads")
               .median());
    solid.points.emplace_back(
        x, measureFrames(context, trace, camera, withEstimator(settings, Estimator::kVolumes))
               .stage("photon_volumes")
               .median());
  }
  plot.series = {quads, solid};
  context.add(std::move(plot));
}

/// The same photons under every kind of shadow, beside rays to all of the lamp.
void picturesOfShadows(Context& context) {
  if (!context.hasTimeFor("pictures of shadows")) return;
  const SceneChoice choice = sceneOf(context, ThesisScene::kCornellBox);
  const TraceScene trace(choice.scene);
  RenderSettings settings = thesisSettings(context, choice.scene, 4, 2, 20'000);
  settings.direct.lightRadius = 0.1f * choice.scene.bounds.size().y;
  const auto pictureOf = [&](Shadows shadows) {
    settings.direct.shadows = shadows;
    settings.direct.areaSamples = context.quick() ? 32 : 256;
    Film film;
    Stats stats;
    CpuRenderer(trace, settings).render(choice.scene.cameras.front(), film, stats, context.job());
    return film.colour;
  };
  const Image truth = pictureOf(Shadows::kArea);
  Table table{.id = "shadows",
              .title = "Shadows beside rays to all of the lamp",
              .caption = fmt::format("{}, the same photons in all; a lamp of {:.2f} m.", choice.name,
                                     settings.direct.lightRadius),
              .columns = {{"shadows"},
                          {"PSNR", Source::kHere, "dB"},
                          {"FLIP", Source::kHere},
                          {"mean", Source::kHere, "ratio"}}};
  PictureSet pictures{.id = "shadows",
                      .title = "Soft shadows beside rays to all of the lamp",
                      .caption = choice.name,
                      .reference = shownPicture("area", truth)};
  for (const auto& [name, shadows] :
       {std::pair{"gathered", Shadows::kGathered}, {"pcss", Shadows::kPcss}, {"hard", Shadows::kTraced}}) {
    pictures.pictures.push_back(judgedPicture(name, pictureOf(shadows), truth));
    const JudgedPicture& judged = pictures.pictures.back();
    table.rows.push_back({name, judged.psnr, judged.flip, Cell(judged.meanRatio, 4)});
  }
  context.add(std::move(table));
  context.add(std::move(pictures));
}

void runSspm(Context& context) {
  context.note(
      "The thesis lights its scenes by spots of a size that it does not tell; here by points, with a radius "
      "of 3 % "
      "of the scene's height.");
  if (context.quick()) context.note("With --quick only some rows of both tables are measured.");
  picturesOfShadows(context);
  tableOfShadows(context);
  tableOfQuads(context);
  plotOfPhotons(context);
}

}  // namespace

const Suite kSspmSuite{"sspm", "Soft shadows and photon quads: the tables of Yao's thesis (2010)", 9,
                       runSspm};

}  // namespace isophote::bench
