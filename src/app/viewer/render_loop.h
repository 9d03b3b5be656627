// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/view_settings.h"
#include "base/job.h"
#include "base/stats.h"
#include "render/cpu_renderer.h"
#include "render/progressive.h"
#include "trace/trace_scene.h"

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace isophote::viewer {

/// What shall be seen.
struct RenderRequest {
  RenderSettings settings;  ///< With the size of the picture.
  ViewSettings view;
  Camera camera;
  std::vector<Light> lights;  ///< Instead of TraceScene::lights(), as many.
  /// More requests will follow at once: the picture may be a draft, and is not refined.
  bool moving = false;
};

/// What has come of it.
struct RenderedPicture {
  std::shared_ptr<const Film> film;
  Stats stats;               ///< Of the frame or pass that was done last.
  double milliseconds = 0;   ///< What that took.
  std::uint64_t number = 0;  ///< RenderLoop::show()'s of the request; 0: there is no picture yet.
  std::uint32_t passes = 0;  ///< Whose mean it is.
  int divisor = 1;           ///< 2, 3, 4: a draft of a half, a third, a quarter of the size.
};

/// How much smaller a draft has to be, so that it takes no longer than so many milliseconds: 1 to 4.
int draftDivisor(double fullMilliseconds, double milliseconds);

/// Renders on a thread of its own what was asked for last, and refines it until something else is asked for.
///
/// A picture of a motion is finished even where the next request is there already, since otherwise none would
/// ever be seen; passes that refine, and pictures of other settings or too large for a motion, are broken off
/// at once.
class RenderLoop {
 public:
  /// `trace` must outlive the loop and belongs to it meanwhile: its lights move. `onPicture` is called on the
  /// loop's thread, for a picture or an error. job.progress is not used.
  RenderLoop(TraceScene& trace, const Job& job, std::function<void()> onPicture);
  /// Breaks off what is being rendered.
  ~RenderLoop();
  RenderLoop(const RenderLoop&) = delete;
  RenderLoop& operator=(const RenderLoop&) = delete;

  /// Asks for another picture; returns its number.
  std::uint64_t show(RenderRequest request);
  /// Exchanges `picture` for the newest one. False where there has been none since the last time.
  bool take(RenderedPicture& picture);
  /// Why there is no picture of the last request; empty: there is one, or will be.
  std::string error() const;
  /// What the renderer warned of in the last picture, one line each.
  std::vector<std::string> warnings() const;
  /// Nothing more will come of what was asked for.
  bool idle() const;

 private:
  using Clock = std::chrono::steady_clock;
  enum class Work { kNone, kFrame, kPass };

  void run();
  /// Waits for something to do; false: the end.
  bool next(std::unique_lock<std::mutex>& lock);
  void work(Work kind);
  void renderFrame();
  void refinePass();
  void publish(std::shared_ptr<const Film> film, std::uint32_t passes, int divisor, double milliseconds);
  /// A film that nobody looks at any more.
  std::shared_ptr<Film> freeFilm();
  bool wantsPass() const;
  /// Takes up what is wanted; says what there is to do for it.
  Work takeUp();
  bool outdates(const RenderRequest& request) const;
  CpuRenderer& rendererOf(int divisor);
  Job jobOfThis();

  TraceScene& trace_;
  Job job_;
  std::function<void()> onPicture_;

  // Of both threads, under the mutex.
  mutable std::mutex mutex_;
  std::condition_variable wake_;
  std::optional<RenderRequest> wanted_;
  std::uint64_t asked_ = 0;
  RenderedPicture ready_;
  bool isNew_ = false;
  bool ending_ = false;
  Work working_ = Work::kNone;
  int divisor_ = 1;  ///< Of the frame that is being rendered.
  std::stop_source stop_;
  std::string error_;
  std::vector<std::string> warnings_;
  double fullMilliseconds_ = 0;  ///< What a frame of the present settings takes at its full size; 0: unknown.

  // The loop's thread's own, but for `request_`, which the other one may read under the mutex.
  RenderRequest request_;
  std::uint64_t number_ = 0;
  RenderedPicture back_;
  std::vector<std::shared_ptr<Film>> films_;
  std::shared_ptr<const Film> frame_;  ///< The last one, from which passes go on.
  std::unique_ptr<CpuRenderer> full_, draft_;
  std::unique_ptr<ProgressiveRenderer> refining_;
  bool goesOn_ = false;  ///< refining_ holds the passes of frame_.
  bool whole_ = false;   ///< There is a full frame of request_.
  std::uint32_t passes_ = 0;
  float radius_ = 0;
  Clock::time_point still_;

  std::thread thread_;  ///< Last: all else is there when it starts.
};

}  // namespace isophote::viewer
