// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// A suite of `isophote bench`: a function that measures and hands in what it came to. To add one: write
// `X_suite.cpp` with a `const Suite kXSuite`, declare it below and list it in suites.cpp; the command line,
// the help, `bench all` and the report find it there. `quality_suite.cpp` is one to look at. In short:
//
//   void runExample(Context& context) {
//     const SceneChoice sponza = context.scene(PublicScene::kSponzaDabrovic);
//     const TraceScene trace(sponza.scene);
//     RenderSettings settings = presetSettings("ispm");
//     context.setSize(settings.frame, 1920, 1080);            // Smaller with --quick and --scale.
//     settings.photonTrace.photons = context.photons(13'688);  // Likewise.
//     const FrameTimes frame = measureFrames(context, trace, sponza.scene.cameras.front(), settings);
//     context.add(Table{.id = "example", .title = "Table 2: frames", .caption = "...", .columns = {{"scene"},
//         {"frame", Source::kPaper, "ms"}, {"frame", Source::kHere, "ms"},
//         {"primary rays", Source::kYardstick, "ms"}},
//         .rows = {{sponza.name, 84.0, frame.clockMs, frame.primaryRaysMs}}});
//   }
//   const Suite kExampleSuite{"example", "One sentence for the help", 10, runExample};
#pragma once

#include "app/bench/report.h"
#include "app/bench/scenes.h"
#include "base/job.h"
#include "image/compare.h"
#include "render/settings.h"
#include "scene/scene.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::bench {

/// Of the suite `quality` alone.
struct QualityOptions {
  std::vector<std::string> scenes;               ///< Empty: the usual ones.
  std::uint32_t width = 0, height = 0, spp = 0;  ///< 0: by --quick.
  double seconds = 0;                            ///< Of rendering, for each way; 0: by --quick.
  std::filesystem::path references;              ///< Keeps path-traced pictures; empty: none are kept.
  std::vector<std::string> assignments;          ///< Settings to measure in place of the usual ways.
};

/// What a person chose on the command line.
struct Options {
  bool quick = false;
  double scale = 0;           ///< Part of the paper's pixels and photons; 0: 1, or 0.25 with --quick.
  std::uint32_t repeats = 0;  ///< 0: 7, or 3 with --quick.
  double budgetSeconds = 0;   ///< Of a suite; 0: none, or the suite's share of a minute with --quick.
  std::vector<std::filesystem::path> assetFolders = {};  ///< Where public scenes are looked for.
  QualityOptions quality = {};
};

/// What a suite works with. One thread uses it.
class Context {
 public:
  /// `changed` is called after each table that is handed in.
  Context(const Options& options, double quickSeconds, Job job, Section& section,
          std::function<void(const Table&)> changed = {});

  const Options& options() const { return options_; }
  bool quick() const { return options_.quick; }
  /// For progress, warnings and stops. Pass it to everything that takes one: Ctrl-C ends a suite through it.
  const Job& job() const { return job_; }

  /// A public scene, or the built-in one that stands in for it where its files are not at hand; a note says
  /// so then. Rows tell SceneChoice::name.
  SceneChoice scene(PublicScene wanted);
  /// A built-in scene, or a file, by the name that `render` takes.
  SceneChoice scene(const std::string& nameOrPath);

  /// Sets the paper's size, or so many of its pixels as were asked for, in the same shape.
  void setSize(FrameSettings& frame, std::uint32_t width, std::uint32_t height) const;
  /// The same of one side: of a shadow map, for one.
  std::uint32_t side(std::uint32_t ofPaper) const;
  /// Of the paper's number of photons, as many as were asked for.
  std::uint32_t photons(std::uint32_t ofPaper) const;

  /// Seconds that are left of the suite's budget; infinite where there is none.
  double secondsLeft() const;
  /// Whether to begin a measurement that takes about `seconds`. Where the budget does not allow it: false,
  /// and a note that `what` was left out for lack of time. The first measurement of a suite is always begun.
  bool hasTimeFor(const std::string& what, double seconds = 0);

  /// Calls `round` once to warm up, forgets what it measured, and calls it as often as was asked for, at
  /// least twice where time runs short. Everything that is compared is measured within a round, turn by turn,
  /// so that a disturbance meets all of it.
  /// `most` bounds the repeats of what takes many seconds.
  void repeat(std::initializer_list<Samples*> samples, const std::function<void()>& round,
              std::uint32_t most = 1000);
  void repeat(std::span<Samples* const> samples, const std::function<void()>& round,
              std::uint32_t most = 1000);

  // What the suite came to, in the order in which readers meet it. A table is also printed at once; its
  // rows are as long as its columns.
  void add(Table table);
  void add(Plot plot) { section_.plots.push_back(std::move(plot)); }
  void add(PictureSet pictures) { section_.pictures.push_back(std::move(pictures)); }
  /// A sentence that readers have to know; the same one twice is told once.
  void note(const std::string& sentence);
  /// The suite's own members of its JSON object.
  nlohmann::ordered_json& data() { return section_.data; }

 private:
  double elapsedSeconds() const;

  const Options& options_;
  double budgetSeconds_;  ///< 0: none.
  bool begun_ = false;
  Job job_;
  Section& section_;
  std::function<void(const Table&)> changed_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Milliseconds of the clock that `work` takes.
double millisecondsOf(const std::function<void()>& work);
/// Processor time of all threads of this process so far [ms]: bears a machine with other work.
double processorMilliseconds();

/// A picture for the report, which halves wide ones until they fit a page. `display` is how it is shown; of a
/// reference, and of what is compared with it, the same one.
ShownPicture shownPicture(const std::string& name, const Image& picture, const DisplayOptions& display = {});
/// Compares, and keeps what the report shows of it: errors, and the part where they are greatest, magnified.
JudgedPicture judgedPicture(const std::string& name, const Image& picture, const Image& reference,
                            const DisplayOptions& display = {});

struct Suite {
  std::string_view name;
  std::string_view description;  ///< One sentence, without a full stop.
  double quickSeconds;           ///< What it may take with --quick; all suites together at most 60.
  void (*run)(Context& context);
  /// Throws what is wrong with the options, before any suite runs; null: nothing can be.
  void (*check)(const Options& options) = nullptr;
};

extern const Suite kIspmSuite;
extern const Suite kIgpmSuite;
extern const Suite kVschSuite;
extern const Suite kEstimatorsSuite;
extern const Suite kQualitySuite;
extern const Suite kSspmSuite;

/// All suites, in the order in which `bench all` runs them.
std::span<const Suite* const> suites();
/// Null where there is none of that name.
const Suite* findSuite(std::string_view name);

/// Runs suites one after the other into `report`. `changed` is called after each table, with the table, and
/// after each suite, with null. Throws Error.
void runSuites(std::span<const Suite* const> chosen, const Options& options, Report& report, const Job& job,
               const std::function<void(const Table*)>& changed = {});

}  // namespace isophote::bench
