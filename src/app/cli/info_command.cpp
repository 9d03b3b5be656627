// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/manual.h"
#include "app/cli/picture.h"
#include "base/error.h"
#include "base/stats.h"
#include "gpu/device.h"
#include "math/simd.h"
#include "render/quality.h"
#include "render/settings.h"
#include "scene/builtin/builtin.h"
#include "settings/apply.h"

#include <fmt/ranges.h>
#include <tbb/info.h>

#include <memory>

namespace isophote::cli {
namespace {

struct InfoOptions {
  PictureOptions picture;
  bool devices = false;
  bool builtin = false;
  bool settings = false;
  bool manual = false;
  std::string completion;  ///< Empty: not asked for.
};

std::string vector(vec3 v) { return fmt::format("({:.4g}, {:.4g}, {:.4g})", v.x, v.y, v.z); }

void printScene(const InfoOptions& options, Host& host) {
  const Scene scene = loadScene(options.picture.scene, options.picture.sceneOptions(), host.job);
  host.console.clear();
  std::uint64_t triangles = 0;
  for (const Instance& instance : scene.instances) triangles += scene.meshes[instance.mesh].triangles.size();
  std::vector<std::string> cameras;
  for (const Camera& camera : scene.cameras) cameras.push_back(fmt::format("\"{}\"", camera.name));
  vec3 power(0.0f);
  for (const Light& light : scene.lights) power += light.power;
  fmt::print("scene      {}\n", options.picture.scene);
  fmt::print("triangles  {} in {} instances of {} meshes\n", triangles, scene.instances.size(),
             scene.meshes.size());
  fmt::print("materials  {}, with {} textures\n", scene.materials.size(), scene.textures.size());
  fmt::print("lights     {}, {} W (red, green, blue) in all\n", scene.lights.size(), vector(power));
  fmt::print("cameras    {}: {}\n", scene.cameras.size(), fmt::join(cameras, ", "));
  fmt::print("bounds     {} to {} m\n", vector(scene.bounds.lower), vector(scene.bounds.upper));
  fmt::print("memory     {:.1f} MiB of geometry and textures\n", double(sceneBytes(scene)) / (1 << 20));
  for (const auto& [key, value] : scene.settings) fmt::print("setting    {} = {}\n", key, value);
}

void printDevices() {
  fmt::print("cpu     {}, {} threads, {}\n", processorName(), tbb::info::default_concurrency(),
             name(bestSimdLevel()));
  std::string whyNone;
  const std::vector<DeviceFacts> devices = listDevices(whyNone);
  if (devices.empty()) fmt::print("vulkan  none: {}\n", whyNone);
  for (const DeviceFacts& device : devices) {
    const std::string unusable = whyUnusable(device);
    fmt::print("vulkan  {} ({}, Vulkan {}.{}.{}){}\n", device.name, name(device.type), device.version.major,
               device.version.minor, device.version.patch,
               unusable.empty() ? "" : ": unusable, it " + unusable);
  }
}

void printBuiltin() {
  for (const BuiltinScene& scene : builtinScenes()) fmt::print("{:<14} {}\n", scene.name, scene.description);
}

/// docs/settings.md is what this prints.
void printSettings() {
  RenderSettings settings;
  fmt::print(R"(# Settings

What `isophote render` can be told: with `--set photon_trace.photons=50000`, in the file of `--settings FILE`
or under `settings` of a scene description, there as `{{"photon_trace.photons": 50000}}`. For common ones
`isophote render --help` lists short options. A width or height that nobody sets follows from the camera's
shape, 720 lines by default. Written by `isophote info --settings`.

{}
## Presets

| `--preset` | what it is |
|---|---|
)",
             settingsTable(fieldsOfGroups(settings)));
  for (const PresetInfo& preset : presets()) fmt::print("| `{}` | {} |\n", preset.name, preset.description);
  fmt::print(R"(
## Qualities

How much work goes into a picture, over the defaults, over a preset and over the scene's own settings; a settings file,
options and `--set` hold over a quality.

| `--quality` | what it is | sets |
|---|---|---|
)");
  for (const Quality& quality : qualities())
    fmt::print("| `{}` | {} | `{}` |\n", quality.name, quality.description,
               fmt::join(quality.assignments, "` `"));
}

void info(const CLI::App& program, const InfoOptions& options, Host& host) {
  const bool scene = !options.picture.scene.empty();
  const bool completion = !options.completion.empty();
  if (scene + options.devices + options.builtin + options.settings + options.manual + completion != 1)
    failUsage("info", "takes one of SCENE, --devices, --builtin, --settings, --manual or --completion");
  if (scene) printScene(options, host);
  if (options.devices) printDevices();
  if (options.builtin) printBuiltin();
  if (options.settings) printSettings();
  if (options.manual) fmt::print("{}", manualPage(program));
  if (completion) fmt::print("{}", completionScript(program, options.completion));
}

}  // namespace

Command addInfo(CLI::App& program) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App& parser =
      *program.add_subcommand("info", "Describe a scene, the devices, the built-in scenes or the settings");
  parser.add_option("SCENE", options->picture.scene, "Scene to describe");
  parser
      .add_option("--assets", options->picture.assets,
                  "Folder to search for models, before those in ISOPHOTE_ASSETS; may be given several times")
      ->type_name("FOLDER")
      ->allow_extra_args(false);
  parser.add_flag("--devices", options->devices, "List the processor and the Vulkan devices");
  parser.add_flag("--builtin", options->builtin, "List the built-in scenes");
  parser.add_flag("--settings", options->settings, "Print all settings and presets, as a Markdown page");
  parser.add_flag("--manual", options->manual, "Print the manual page, as roff");
  parser
      .add_option("--completion", options->completion,
                  "Print a completion script for that shell: bash or zsh")
      ->type_name("SHELL");
  parser.footer("\nExamples:\n  isophote info cornell-box\n  isophote info --builtin");
  return {&parser, [options, &program](Host& host) { info(program, *options, host); }};
}

}  // namespace isophote::cli
