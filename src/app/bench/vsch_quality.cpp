// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// VSCH: pictures beside path-traced ones (table 2, figures 10 and 11), the bias of the two weights of
// octants, and glossy surfaces (figure 12).
#include "app/bench/vsch_parts.h"
#include "image/compare.h"
#include "render/cpu_frame.h"
#include "render/reference.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <vector>

namespace isophote::bench {
namespace {

/// Pictures are judged at a third of the paper's width: cells of the screen and the blur are, too.
constexpr std::uint32_t kWidth = 640, kHeight = 360;

/// SSIM [%] and PSNR [dB], as printed.
struct Printed {
  double ssim, psnr;
};
/// A row of table 2.
struct QualityRow {
  VschSetUp setUp;
  Printed cluster, directional, tiled;
};
struct QualityScene {
  PublicScene scene;
  std::array<QualityRow, 6> rows;
};

constexpr std::array kScenes{
    QualityScene{PublicScene::kSponzaCrytek,
                 {{{{10'000, 4.0f}, {90, 25}, {91, 27}, {90, 24}},
                   {{50'000, 2.0f}, {91, 26}, {90, 25}, {92, 27}},
                   {{200'000, 1.2f}, {93, 30}, {92, 27}, {93, 30}},
                   {{1'000'000, 0.7f}, {94, 32}, {92, 27}, {94, 32}},
                   {{5'000'000, 0.5f}, {94, 32}, {92, 27}, {94, 32}},
                   {{50'000'000, 0.2f}, {95, 33}, {89, 25}, {95, 33}}}}},
    QualityScene{PublicScene::kSibenik,
                 {{{{10'000, 5.0f}, {91, 28}, {87, 27}, {92, 27}},
                   {{50'000, 2.0f}, {88, 31}, {85, 28}, {89, 31}},
                   {{200'000, 1.5f}, {94, 32}, {89, 28}, {93, 32}},
                   {{1'000'000, 1.0f}, {95, 34}, {90, 28}, {95, 34}},
                   {{5'000'000, 0.6f}, {96, 36}, {94, 30}, {95, 36}},
                   {{50'000'000, 0.2f}, {96, 38}, {93, 30}, {96, 38}}}}},
};
/// What a photon takes at the peak of a frame, in the map, in a method's copy of it and in lists [B].
constexpr std::uint64_t kBytesPerPhoton = 110;
/// What a photon of a row takes on two cores, three methods together [s].
constexpr double kSecondsPerPhoton = 7e-6;

/// What may be used, and what there is [B].
std::uint64_t memoryAtHand(const Job& job) {
  return std::min(job.memoryBudgetBytes,
                  std::uint64_t(sysconf(_SC_PHYS_PAGES)) * std::uint64_t(sysconf(_SC_PAGESIZE)));
}

Film pathTraced(Context& context, const Scene& scene, const Camera& camera, const RenderSettings& like) {
  ReferenceSettings settings;
  settings.width = like.frame.width;
  settings.height = like.frame.height;
  settings.bounces = like.frame.bounces;
  settings.spp = context.quick() ? 24 : 128;
  settings.aa = 1;
  Stats stats;
  return renderReference(scene, camera, settings, stats, context.job());
}

RenderSettings judgedSettings(const Context& context, VschMethod method, VschSetUp setUp) {
  RenderSettings settings = vschSettings(context, method, setUp, kWidth, kHeight);
  settings.photonClusters.size = ClusterSize::k4x4;
  settings.photonDirectional.cells = kWidth / 4;
  settings.irradianceBlur.radius = 4;
  settings.irradianceBlur.step = 1;
  settings.frame.layers = true;
  return settings;
}

/// A picture, and what its splatting took, once [ms].
struct Rendered {
  Film film;
  double splatMs = 0;
};

Rendered render(Context& context, const VschScene& scene, const RenderSettings& settings) {
  Stats stats;
  Film film = renderCpu(*scene.trace, scene.camera(), settings, stats, context.job());
  return {std::move(film), splatMs(stats)};
}

Table qualityTable() {
  return {
      .id = "table2",
      .title = "Table 2: pictures beside path-traced ones",
      .caption = fmt::format(
          "SSIM in %, PSNR in dB; pictures of {} x {} where nothing is scaled, the paper's of 1920 x 1080. "
          "\"cluster\" is cluster-trivial. Other models, lamps and tone mapping than the paper's: orderings "
          "compare, figures do not.",
          kWidth, kHeight),
      .columns = {{"measured"},
                  {"photons", Source::kHere},
                  {"radius", Source::kHere, "m"},
                  {"cluster, SSIM", Source::kPaper},
                  {"cluster, SSIM", Source::kHere},
                  {"cluster, PSNR", Source::kPaper},
                  {"cluster, PSNR", Source::kHere},
                  {"directional, SSIM", Source::kPaper},
                  {"directional, SSIM", Source::kHere},
                  {"directional, PSNR", Source::kPaper},
                  {"directional, PSNR", Source::kHere},
                  {"tiled, SSIM", Source::kPaper},
                  {"tiled, SSIM", Source::kHere},
                  {"tiled, PSNR", Source::kPaper},
                  {"tiled, PSNR", Source::kHere}}};
}

Table biasTable() {
  return {.id = "octants",
          .title = "Bias of the weights of octants",
          .caption =
              "Mean of the indirect light over the path tracer's. \"part\" weighs octants of the world by "
              "what the normals see of them, \"published\" those of the view by twice a cosine. "
              "\"tiled\" has the bias of the radius alone.",
          .columns = {{"measured"},
                      {"photons", Source::kHere},
                      {"radius", Source::kHere, "m"},
                      {"part", Source::kHere},
                      {"published", Source::kHere},
                      {"cluster-trivial", Source::kHere},
                      {"tiled", Source::kYardstick}}};
}

double indirectRatio(const Film& film, const Film& reference) {
  return compareImages(film.layers.at("indirect"), reference.layers.at("indirect")).meanRatio;
}

/// Rows of one scene, and its pictures.
class SceneQuality {
 public:
  SceneQuality(Context& context, const VschScene& scene) : context_(context), scene_(&scene) {
    reference_ = pathTraced(context, scene_->choice.scene, scene_->camera(),
                            judgedSettings(context, VschMethod::kTiled, kVschUsual));
  }

  void addRow(const QualityRow& row, Table& table) {
    const RenderSettings shown = judgedSettings(context_, VschMethod::kTiled, row.setUp);
    std::vector<Cell> cells{scene_->choice.name, double(shown.photonTrace.photonsStored),
                            double(shown.photonTiles.radius)};
    const auto add = [&](VschMethod method, Printed printed) {
      Rendered rendered = render(context_, *scene_, judgedSettings(context_, method, row.setUp));
      const Comparison measured = compareImages(rendered.film.colour, reference_.colour);
      cells.insert(cells.end(), {printed.ssim, 100 * measured.ssim, printed.psnr, measured.psnr});
      return rendered;
    };
    const Rendered cluster = add(VschMethod::kClusterTrivial, row.cluster);
    const Rendered directional = add(VschMethod::kDirectional, row.directional);
    const Rendered tiled = add(VschMethod::kTiled, row.tiled);
    table.rows.push_back(std::move(cells));
    if (row.setUp.photons == kVschUsual.photons)
      showMethods(row.setUp, cluster.film, directional.film, tiled.film);
    const Shown shownNow{shown.photonTrace.photonsStored, cluster.splatMs, cluster.film.colour};
    if (row.setUp.photons == kVschFew.photons) few_ = shownNow;
    many_ = shownNow;
  }

  void addBias(VschSetUp setUp, Table& table) {
    const RenderSettings shown = judgedSettings(context_, VschMethod::kTiled, setUp);
    const auto ratio = [&](VschMethod method) {
      return indirectRatio(render(context_, *scene_, judgedSettings(context_, method, setUp)).film,
                           reference_);
    };
    table.rows.push_back({scene_->choice.name, double(shown.photonTrace.photonsStored),
                          double(shown.photonTiles.radius), ratio(VschMethod::kDirectional),
                          ratio(VschMethod::kDirectionalPublished), ratio(VschMethod::kClusterTrivial),
                          ratio(VschMethod::kTiled)});
  }

  void showFewAndMany() {
    if (few_.picture.pixels.empty() || many_.picture.pixels.empty()) return;
    const auto judged = [&](const Shown& shown) {
      return judgedPicture(fmt::format("{} photons, splatting {:.0f} ms", shown.photons, shown.splatMs),
                           shown.picture, reference_.colour);
    };
    context_.add(PictureSet{
        .id = "figure11-" + scene_->choice.scene.name,
        .title = fmt::format("Figure 11: {}, few large photons and many small ones", scene_->choice.name),
        .caption =
            "cluster-trivial, timed once; the paper has 10 k of radius 4 in 10 ms, 50 M of radius 0.2 in 290 "
            "ms, at 1920 x 1080 on a Titan X.",
        .reference = shownPicture("path-traced", reference_.colour),
        .pictures = {judged(few_), judged(many_)}});
  }

 private:
  /// A picture by cluster-trivial, and what its splatting took [ms].
  struct Shown {
    std::uint32_t photons = 0;
    double splatMs = 0;
    Image picture;
  };

  void showMethods(VschSetUp setUp, const Film& cluster, const Film& directional, const Film& tiled) {
    context_.add(
        PictureSet{.id = "figure10-" + scene_->choice.scene.name,
                   .title = fmt::format("Figure 10: {}, {} photons of radius {}", scene_->choice.name,
                                        context_.photons(setUp.photons), setUp.radius),
                   .caption = "The three methods beside a path-traced picture.",
                   .reference = shownPicture("path-traced", reference_.colour),
                   .pictures = {judgedPicture("cluster-trivial", cluster.colour, reference_.colour),
                                judgedPicture("directional", directional.colour, reference_.colour),
                                judgedPicture("tiled", tiled.colour, reference_.colour)}});
  }

  Context& context_;
  const VschScene* scene_;
  Film reference_;
  Shown few_, many_;
};

/// The room of mixed materials with one roughness for all that reflects.
Scene glossyRoom(float roughness) {
  Scene scene = loadScene("cornell-objects");
  for (NamedMaterial& material : scene.materials) {
    material.transmission = 0;
    if (material.metallic == 0) material.specular = 1;
    material.roughness = roughness;
  }
  return scene;
}

}  // namespace

void benchVschQuality(Context& context, VschScenes& scenes) {
  Table table = qualityTable(), bias = biasTable();
  for (const QualityScene& paper : kScenes) {
    const bool first = table.rows.empty();
    if (!context.hasTimeFor(first ? "table 2" : "table 2, Sibenik", 3)) continue;
    SceneQuality quality(context, scenes[paper.scene]);
    quality.addBias(kVschUsual, bias);
    for (const std::size_t i : {2, 0, 1, 3, 4, 5}) {
      const QualityRow& row = paper.rows[i];
      const std::uint32_t photons = context.photons(row.setUp.photons);
      if (photons * kBytesPerPhoton > memoryAtHand(context.job())) {
        context.note(fmt::format("Rows of table 2 with {} photons are left out: they take {} MiB of memory.",
                                 photons, (photons * kBytesPerPhoton >> 20) + 1));
        continue;
      }
      if (context.hasTimeFor(fmt::format("table 2, {} photons", row.setUp.photons),
                             std::max(2.0, kSecondsPerPhoton * photons)))
        quality.addRow(row, table);
    }
    quality.showFewAndMany();
  }
  if (!bias.rows.empty()) context.add(std::move(bias));
  if (!table.rows.empty()) context.add(std::move(table));
}

void benchVschGlossy(Context& context) {
  if (!context.hasTimeFor("figure 12", 2)) return;
  Table table{.id = "figure12",
              .title = "Figure 12: glossy surfaces",
              .caption =
                  "cornell-objects, all of one roughness, 50 k photons of radius 0.15 m; the paper shows "
                  "objects of varying roughness, 50 k photons of radius 1. Its photons, as ours, are felt "
                  "with the full BSDF; directional treats the reflection as diffuse.",
              .columns = {{"roughness"},
                          {"frame", Source::kPaper, "ms"},
                          {"cluster, frame", Source::kHere, "ms"},
                          {"cluster, splatting", Source::kHere, "ms"},
                          {"cluster, PSNR", Source::kHere, "dB"},
                          {"directional, splatting", Source::kHere, "ms"},
                          {"directional, PSNR", Source::kHere, "dB"},
                          {"primary rays", Source::kYardstick, "ms"}}};
  constexpr VschSetUp kGlossy{50'000, 0.15f};
  for (const float roughness : {0.5f, 0.3f, 0.8f}) {
    if (!context.hasTimeFor(fmt::format("figure 12, roughness {}", roughness), 2)) continue;
    const Scene scene = glossyRoom(roughness);
    const TraceScene trace(scene);
    const Camera& camera = scene.cameras.front();
    const auto frames = [&](VschMethod method) {
      return measureFrames(context, trace, camera, vschSettings(context, method, kGlossy, kWidth, kHeight),
                           3);
    };
    const FrameTimes cluster = frames(VschMethod::kClusterCone);
    const FrameTimes directional = frames(VschMethod::kDirectional);
    const Image reference =
        pathTraced(context, scene, camera,
                   vschSettings(context, VschMethod::kClusterCone, kGlossy, kWidth, kHeight))
            .colour;
    PictureSet set{.id = fmt::format("figure12-{}", table.rows.size()),
                   .title = fmt::format("Figure 12: roughness {}", roughness),
                   .caption = "Glossy surfaces by two methods.",
                   .reference = shownPicture("path-traced", reference),
                   .pictures = {judgedPicture("cluster", cluster.film.colour, reference),
                                judgedPicture("directional", directional.film.colour, reference)}};
    table.rows.push_back({double(roughness), 34.0, cluster.clockMs, splatMs(cluster), set.pictures[0].psnr,
                          splatMs(directional), set.pictures[1].psnr, cluster.primaryRaysMs});
    context.add(std::move(set));
  }
  if (!table.rows.empty()) context.add(std::move(table));
}

}  // namespace isophote::bench
