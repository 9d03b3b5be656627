// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/picture.h"
#include "app/cli/setting_options.h"
#include "base/error.h"
#include "render/reference.h"
#include "settings/apply.h"

#include <memory>

namespace isophote::cli {
namespace {

const std::vector<SettingOption>& settingOptions() {
  static const std::vector<SettingOption> options{
      {"--width", "N", {"width"}, "", "by the camera's shape"},
      {"--height", "N", {"height"}, "", "720, or by the width and the camera's shape"},
      {"--aa", "N", {"aa"}},
      {"--spp", "N", {"spp"}},
      {"--time", "SECONDS", {"timeSeconds"}},
      {"--bounces", "N", {"bounces"}},
      {"--seed", "N", {"seed"}},
  };
  return options;
}

struct ReferenceOptions {
  PictureOptions picture;
  bool indirectOnly = false;
  std::vector<GivenSetting> given;
};

void reference(const ReferenceOptions& options, Host& host) {
  ReferenceSettings settings;
  settings.width = settings.height = 0;
  settings.indirectOnly = options.indirectOnly;
  applyGiven(fieldsOf(settings), options.given);
  const DisplayOptions display = options.picture.check();

  Stats stats;
  const Scene scene = [&] {
    const auto scope = stats.scope("load");
    return loadScene(options.picture.scene, options.picture.sceneOptions(), host.job);
  }();
  const Camera& camera = findCamera(scene, options.picture.camera);
  completeSize(settings.width, settings.height, camera);
  const Film film = renderReference(scene, camera, settings, stats, host.job);
  options.picture.write(film, display, stats, host);
}

}  // namespace

Command addReference(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<ReferenceOptions>();
  CLI::App& parser = *program.add_subcommand("reference", "Path-trace a scene without bias, to compare with");
  options->picture.addTo(parser, work);
  ReferenceSettings defaults;
  addSettingOptions(parser, settingOptions(), fieldsOf(defaults), options->given);
  parser.add_flag("--indirect-only", options->indirectOnly, "Leave out direct and emitted light");
  parser.footer(
      "\nExamples:\n"
      "  isophote reference cornell-box -o reference.exr --spp 1024\n"
      "  isophote reference room.glb -o reference.exr --time 600 --bounces 3");
  return {&parser, [options](Host& host) { reference(*options, host); }};
}

}  // namespace isophote::cli
