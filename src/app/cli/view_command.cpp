// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/frame_options.h"
#include "app/cli/picture.h"
#include "app/viewer/script.h"
#include "app/viewer/session.h"
#include "app/viewer/viewer.h"
#include "base/files.h"
#include "render/cpu_frame.h"
#include "settings/apply.h"

#include <memory>

namespace isophote::cli {
namespace {

struct ViewOptions {
  PictureOptions picture;
  FrameOptions frame;
  std::filesystem::path script;
};

/// The viewer's settings over that preset; a size that nobody chose is 0.
viewer::ViewerSettings chosenSettings(const ViewOptions& options, std::string_view preset,
                                      const Scene* scene) {
  viewer::ViewerSettings settings;
  settings.display = options.picture.display();
  if (!preset.empty()) settings.render = presetSettings(preset);
  settings.render.frame.width = settings.render.frame.height = 0;
  options.frame.apply(fieldsOfGroups(settings), scene, options.picture.scene);
  settings.render.frame.layers = settings.render.frame.densityLayer = false;  // Nobody sees them.
  return settings;
}

void view(const ViewOptions& options, Host& host) {
  constexpr std::uint64_t kLargestScript = 1 << 20;
  chosenSettings(options, options.frame.preset, nullptr);  // Refuses what is mistyped before all else.
  std::vector<viewer::ScriptCommand> script;
  if (!options.script.empty())
    script = viewer::parseScript(readFile(options.script, kLargestScript), options.script.string());
  viewer::Viewer viewer(options.picture.scene, std::move(script), options.script);

  const Scene scene = loadScene(options.picture.scene, options.picture.sceneOptions(), host.job);
  viewer::ViewerSettings settings = chosenSettings(options, options.frame.preset, &scene);
  const Camera& camera = findCamera(scene, options.picture.camera);
  FrameSettings& frame = settings.render.frame;
  completeSize(frame.width, frame.height, camera);
  Stats stats;
  const std::unique_ptr<TraceScene> trace = buildTrace(scene, stats, host.job);
  host.console.clear();
  viewer::Session session(scene, camera, settings, options.frame.preset, [&](std::string_view preset) {
    return chosenSettings(options, preset, &scene).render;
  });
  session.setPictureSize(int(frame.width), int(frame.height));
  viewer.run(session, *trace, host.job);
}

}  // namespace

Command addView(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<ViewOptions>();
  CLI::App& parser = *program.add_subcommand("view", "Fly through a scene and move its lights, in a window");
  options->picture.addSceneTo(parser);
  options->picture.addDisplayTo(parser);
  addWorkOptions(parser, work);
  options->frame.addPresetTo(parser);
  options->frame.addShortTo(parser);
  options->frame.addSettingsTo(parser);
  parser.add_option("--script", options->script, "Play the commands in this file instead of taking input")
      ->type_name("FILE")
      ->take_last();
  parser.footer(
      "\nExamples:\n"
      "  isophote view cornell-box\n"
      "  isophote view atrium --preset ispm --width 1280 --height 720\n"
      "  isophote view room.glb --tonemap aces --set view.draftMilliseconds=100\n"
      "\nThe key H shows what keys and mouse do. --set takes view.* and display.* as well.");
  return {&parser, [options](Host& host) { view(*options, host); }};
}

}  // namespace isophote::cli
