// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/frame_options.h"
#include "app/cli/picture.h"
#include "base/error.h"
#include "base/files.h"
#include "image/files.h"
#include "render/checkpoint.h"
#include "render/cpu_frame.h"
#include "render/progressive.h"
#include "render/settings.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <optional>

namespace isophote::cli {
namespace {

struct RenderOptions {
  PictureOptions picture;
  FrameOptions frame;
  std::string engine = "auto";
  std::filesystem::path checkpoint;  ///< Empty: none.
  bool progressive = false;
};

/// The frame's settings; a size that nobody chose is 0.
RenderSettings chosenSettings(const RenderOptions& options, const Scene* scene) {
  RenderSettings settings = options.frame.presetOrDefaults();
  settings.frame.width = settings.frame.height = 0;
  options.frame.apply(fieldsOfGroups(settings), scene, options.picture.scene);
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

/// Renders the passes of a picture that converges, and keeps its files up to date meanwhile.
class PassRender {
 public:
  PassRender(const RenderOptions& options, const DisplayOptions& display, const RenderSettings& settings,
             const TraceScene& trace, const Camera& camera, Stats& stats, Host& host)
      : options_(options),
        display_(display),
        settings_(settings),
        camera_(camera),
        stats_(stats),
        host_(host),
        renderer_(trace, settings) {
    if (options.checkpoint.empty()) return;
    checkpoint_.emplace(options.checkpoint, trace.scene(), camera);
    if (!checkpoint_->exists()) return;
    checkpoint_->load(renderer_, settings, host.job);
    host.console.note(
        fmt::format("going on after {} passes of {}", renderer_.passes(), options.checkpoint.string()));
  }

  const Film& run() {
    try {
      addPasses(renderer_, camera_, settings_.frame, stats_, host_.job, [&] { refresh(); });
    } catch (const Error&) {
      // What passes have come to is not lost.
      if (checkpoint_ && renderer_.passes() > 0) {
        checkpoint_->save(renderer_);
        host_.console.note(fmt::format("{} passes are kept in {}; the same command goes on from there",
                                       renderer_.passes(), checkpoint_->path().string()));
      }
      throw;
    }
    if (checkpoint_) checkpoint_->save(renderer_);
    return renderer_.film();
  }

 private:
  using Clock = std::chrono::steady_clock;

  /// Files are written where that takes a small part of the time.
  void refresh() {
    constexpr std::chrono::seconds kPicture{1}, kCheckpoint{30};
    const auto time = Clock::now();
    if (options_.progressive && time - shown_ > std::max<Clock::duration>(kPicture, 10 * showing_)) {
      options_.picture.writePicture(renderer_.film(), display_);
      shown_ = Clock::now();
      showing_ = shown_ - time;
    }
    if (checkpoint_ && time - saved_ > kCheckpoint) {
      checkpoint_->save(renderer_);
      saved_ = Clock::now();
    }
  }

  const RenderOptions& options_;
  const DisplayOptions& display_;
  const RenderSettings& settings_;
  const Camera& camera_;
  Stats& stats_;
  Host& host_;
  ProgressiveRenderer renderer_;
  std::optional<Checkpoint> checkpoint_;
  Clock::time_point shown_{}, saved_ = Clock::now();
  Clock::duration showing_{};  ///< How long writing the picture takes.
};

void render(const RenderOptions& options, Host& host) {
  requireEngine(options.engine);
  chosenSettings(options, nullptr);  // Refuses what is mistyped before the scene is loaded.
  const DisplayOptions display = options.picture.check();
  if (!options.checkpoint.empty()) {
    if (!holdsLayers(options.checkpoint))
      failUsage("--checkpoint", "{} cannot be a checkpoint; give it a name that ends in .exr",
                options.checkpoint.string());
    if (options.checkpoint.lexically_normal() == options.picture.output.lexically_normal())
      failUsage("--checkpoint", "names the picture's own file; give it another");
    requireWritable(options.checkpoint);
  }

  Stats stats;
  const Scene scene = [&] {
    const auto scope = stats.scope("load");
    return loadScene(options.picture.scene, options.picture.sceneOptions(), host.job);
  }();
  RenderSettings settings = chosenSettings(options, &scene);
  if (!options.picture.wantsLayers() && options.checkpoint.empty()) settings.frame.layers = false;
  const Camera& camera = findCamera(scene, options.picture.camera);
  completeSize(settings.frame.width, settings.frame.height, camera);
  if (!hasPasses(settings.frame)) {
    for (const auto& [given, option] : {std::pair(options.progressive, "--progressive"),
                                        std::pair(!options.checkpoint.empty(), "--checkpoint")})
      if (given) failUsage(option, "is for pictures of several passes; give --passes or --time");
    const Film film = renderCpu(scene, camera, settings, stats, host.job);
    return options.picture.write(film, display, stats, host);
  }
  const std::unique_ptr<TraceScene> trace = buildTrace(scene, stats, host.job);
  PassRender passes(options, display, settings, *trace, camera, stats, host);
  options.picture.write(passes.run(), display, stats, host);
}

}  // namespace

Command addRender(CLI::App& program, WorkOptions& work) {
  auto options = std::make_shared<RenderOptions>();
  CLI::App& parser = *program.add_subcommand("render", "Light a scene with photons");
  options->picture.addTo(parser, work);
  options->frame.addPresetTo(parser);
  parser
      .add_option("--engine", options->engine,
                  "auto or cpu; vulkan does not render whole frames in this version [auto]")
      ->type_name("NAME")
      ->take_last();
  options->frame.addShortTo(parser);
  parser.add_flag("--progressive", options->progressive,
                  "Write the picture of the passes so far again and again while they are added");
  parser
      .add_option("--checkpoint", options->checkpoint,
                  "Keep what passes have come to in this .exr; the same command goes on from it")
      ->type_name("FILE");
  options->frame.addSettingsTo(parser);
  parser.footer(
      "\nExamples:\n"
      "  isophote render cornell-box -o cornell.png\n"
      "  isophote render cornell-box -o fine.png --quality final\n"
      "  isophote render room.glb -o room.exr --width 1920 --height 1080 --photons 1000000 --stats "
      "room-stats.json\n"
      "  isophote render atrium -o a.exr --time 60 --progressive --checkpoint a-passes.exr\n"
      "  isophote render cornell-box -o k.png --estimator kdtree --set photon_kdtree.nearest=200\n"
      "\nA scene's own settings hold over the preset's, --quality over both; a settings file, then options, "
      "then --set hold over all.");
  return {&parser, [options](Host& host) { render(*options, host); }};
}

}  // namespace isophote::cli
