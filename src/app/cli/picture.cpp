// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/picture.h"

#include "base/error.h"
#include "base/files.h"
#include "image/compare.h"
#include "image/files.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

namespace isophote::cli {

namespace {

constexpr std::array<std::string_view, 3> kShownLayers{"direct", "indirect", "emitted"};

}  // namespace

void PictureOptions::addSceneTo(CLI::App& parser) {
  parser
      .add_option("SCENE", scene,
                  "A .gltf, .glb or .obj file, a scene description (.json), or a built-in scene (isophote "
                  "info --builtin)")
      ->required();
  parser.add_option("--camera", camera, "Camera of the scene, by name; otherwise the first")
      ->type_name("NAME");
  parser
      .add_option("--assets", assets,
                  "Folder to search for models, before those in ISOPHOTE_ASSETS; may be given several times")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
}

void PictureOptions::addDisplayTo(CLI::App& parser) {
  parser.add_option("--exposure", exposure, "Brighten a PNG by 2^EV, or auto [0]")
      ->type_name("EV")
      ->take_last();
  parser.add_option("--tonemap", toneMap, "Curve for a PNG: none, aces or reinhard [none]")
      ->type_name("NAME")
      ->take_last();
}

void PictureOptions::addTo(CLI::App& parser, WorkOptions& work) {
  addSceneTo(parser);
  parser.add_option("-o,--output", output, "Picture to write: .exr (linear, with layers) or .png")
      ->type_name("FILE")
      ->required();
  parser.add_option("--stats", stats, "Write times, counts and memory as JSON")->type_name("FILE");
  addDisplayTo(parser);
  parser
      .add_option("--layer", layer, "Show only this part of the light in a PNG: direct, indirect or emitted")
      ->type_name("NAME")
      ->take_last();
  addWorkOptions(parser, work);
}

DisplayOptions PictureOptions::display() const {
  DisplayOptions display;
  if (!exposure.empty()) parseExposure(exposure, display);
  if (!toneMap.empty())
    setSetting(fieldsOf(display), "toneMap", toneMap, {ErrorKind::kBadUsage, "--tonemap"});
  return display;
}

DisplayOptions PictureOptions::check() const {
  const DisplayOptions shown = display();
  if (!layer.empty() && std::find(kShownLayers.begin(), kShownLayers.end(), layer) == kShownLayers.end())
    failUsage("--layer", "\"{}\" is not a part of the light{}; there is {}", layer,
              suggestion(layer, kShownLayers), fmt::join(kShownLayers, ", "));
  requireFilmFormat(output);
  if (stats.lexically_normal() == output.lexically_normal())
    failUsage("--stats", "names the picture's own file; give it another");
  requireWritable(output);
  if (!stats.empty()) requireWritable(stats);
  return shown;
}

SceneOptions PictureOptions::sceneOptions() const {
  SceneOptions options;
  options.assetFolders = assets;
  if (const char* environment = std::getenv("ISOPHOTE_ASSETS")) {
    std::string_view rest = environment;
    while (!rest.empty()) {
      const std::string_view folder = rest.substr(0, rest.find(':'));
      if (!folder.empty()) options.assetFolders.emplace_back(folder);
      rest.remove_prefix(std::min(rest.size(), folder.size() + 1));
    }
  }
  return options;
}

bool PictureOptions::wantsLayers() const { return holdsLayers(output) || !layer.empty(); }

void PictureOptions::writePicture(const Film& film, const DisplayOptions& display) const {
  if (holdsLayers(output) || layer.empty())
    writeFilm(output, film, display);
  else
    writeFilm(output,
              {.colour = selectLayer(film, layer, output.string()), .layers = {}, .metadata = film.metadata},
              display);
}

void PictureOptions::write(const Film& film, const DisplayOptions& display, const Stats& measured,
                           Host& host) const {
  if (holdsLayers(output) && !(exposure.empty() && toneMap.empty() && layer.empty()))
    host.console.warn("--exposure, --tonemap and --layer change PNG pictures only; " + output.string() +
                      " holds linear radiance and all layers");
  host.job.throwIfStopped();
  writePicture(film, display);
  if (!stats.empty()) writeFileAtomically(stats, measured.toJson());
  host.console.note(fmt::format("{}: {} x {} pixels, {:.1f} s", output.string(), film.colour.width,
                                film.colour.height, measured.totalMilliseconds() / 1000));
}

void completeSize(std::uint32_t& width, std::uint32_t& height, const Camera& camera) {
  static constexpr double kLargest = 16384;
  const double aspect = camera.aspect > 0 ? camera.aspect : 16.0 / 9.0;
  const auto rounded = [](double pixels) {
    return std::uint32_t(std::clamp(std::round(pixels), 1.0, kLargest));
  };
  if (width == 0 && height == 0) height = 720;
  if (width == 0) width = rounded(height * aspect);
  if (height == 0) height = rounded(width / aspect);
}

}  // namespace isophote::cli
