// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/picture.h"
#include "app/cli/setting_options.h"
#include "base/error.h"
#include "base/files.h"
#include "render/cpu_frame.h"
#include "render/settings.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <memory>

namespace isophote::cli {
namespace {

const std::vector<SettingOption>& settingOptions() {
  static const std::vector<SettingOption> options{
      {"--width", "N", {"frame.width"}, "", "by the camera's shape"},
      {"--height", "N", {"frame.height"}, "", "720, or by the width and the camera's shape"},
      {"--aa", "N", {"frame.aa"}},
      {"--bounces", "N", {"frame.bounces"}},
      {"--estimator", "NAME", {"frame.estimator"}},
      {"--photons", "N", {"photon_trace.photons"}},
      {"--photons-stored", "N", {"photon_trace.photonsStored"}},
      {"--radius",
       "METRES",
       {"photon_volumes.radius", "photon_kdtree.radius", "photon_tiles.radius"},
       "Radius in which a photon is felt (volumes, tiles) or photons are gathered (kdtree); 0: automatic."},
      {"--shadows", "traced|map", {"direct.shadows"}},
      {"--subsample", "N", {"frame.subsample"}},
      {"--seed", "N", {"frame.seed"}},
  };
  return options;
}

struct RenderOptions {
  PictureOptions picture;
  std::string preset;
  std::string engine = "auto";
  std::filesystem::path settingsFile;
  std::vector<std::string> assignments;
  std::vector<GivenSetting> given;
};

/// Defaults, then the scene's wishes, then the preset, the settings file, the options and --set: the later
/// ones hold. A size that nobody chose is 0.
RenderSettings chosenSettings(const RenderOptions& options, const Scene* scene) {
  RenderSettings settings;
  if (!options.preset.empty()) settings = presetSettings(options.preset);
  settings.frame.width = settings.frame.height = 0;
  const std::vector<Field> fields = fieldsOfGroups(settings);
  if (scene)
    for (const auto& [key, value] : scene->settings)
      setSetting(fields, key, value, {ErrorKind::kBadInput, options.picture.scene});
  if (!options.settingsFile.empty())
    setFromJson(fields, readFile(options.settingsFile),
                {ErrorKind::kBadInput, options.settingsFile.string()});
  applyGiven(fields, options.given);
  for (const std::string& assignment : options.assignments)
    setFromAssignment(fields, assignment, {ErrorKind::kBadUsage, "--set"});
  return settings;
}

void requireEngine(const std::string& engine) {
  if (engine == "auto" || engine == "cpu") return;
  if (engine == "vulkan")
    failUsage("--engine", "vulkan does not render whole frames in this version; use cpu or auto");
  const std::array<std::string_view, 3> names{"auto", "cpu", "vulkan"};
  failUsage("--engine", "there is no engine \"{}\"{}; there is auto, cpu, vulkan", engine,
            suggestion(engine, names));
}

void render(const RenderOptions& options, Host& host) {
  requireEngine(options.engine);
  chosenSettings(options, nullptr);  // Refuses what is mistyped before the scene is loaded.
  const DisplayOptions display = options.picture.check();

  Stats stats;
  const Scene scene = [&] {
    const auto scope = stats.scope("load");
    return loadScene(options.picture.scene, options.picture.sceneOptions(), host.job);
  }();
  RenderSettings settings = chosenSettings(options, &scene);
  if (!options.picture.wantsLayers()) settings.frame.layers = false;
  const Camera& camera = findCamera(scene, options.picture.camera);
  completeSize(settings.frame.width, settings.frame.height, camera);
  const Film film = renderCpu(scene, camera, settings, stats, host.job);
  options.picture.write(film, display, stats, host);
}

}  // namespace

Command addRender(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App& parser = *program.add_subcommand("render", "Light a scene with photons");
  options->picture.addTo(parser, work);
  parser.add_option("--preset", options->preset, "Settings of a published system (isophote info --settings)")
      ->type_name("NAME")
      ->take_last();
  parser
      .add_option("--engine", options->engine,
                  "auto or cpu; vulkan does not render whole frames in this version [auto]")
      ->type_name("NAME")
      ->take_last();
  RenderSettings defaults;
  addSettingOptions(parser, settingOptions(), fieldsOfGroups(defaults), options->given);
  parser.add_option("--settings", options->settingsFile, "JSON file of settings")
      ->type_name("FILE")
      ->take_last();
  parser
      .add_option("--set", options->assignments,
                  "Any setting, for example photon_trace.photons=1e6; may be given several times")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  parser.footer(
      "\nExamples:\n"
      "  isophote render cornell-box -o cornell.png\n"
      "  isophote render room.glb -o room.exr --width 1920 --height 1080 --photons 1000000 --stats "
      "room-stats.json\n"
      "  isophote render cornell-box -o k.png --estimator kdtree --set photon_kdtree.nearest=200\n"
      "\nA scene's own settings hold over the preset's; a settings file, then options, then --set hold over "
      "both.");
  return {&parser, [options](Host& host) { render(*options, host); }};
}

}  // namespace isophote::cli
