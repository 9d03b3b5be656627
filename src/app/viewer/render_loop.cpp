// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/render_loop.h"

#include "base/error.h"

#include <algorithm>
#include <cmath>
#include <new>
#include <tuple>

namespace isophote::viewer {

namespace {

bool sameView(const Camera& a, const Camera& b) {
  const auto all = [](const Camera& c) {
    return std::tie(c.eye, c.target, c.up, c.verticalFovDegrees, c.orthographicHeight);
  };
  return all(a) == all(b);
}

bool sameLights(const std::vector<Light>& a, const std::vector<Light>& b) {
  const auto same = [](const Light& x, const Light& y) {
    return x.position == y.position && x.direction == y.direction;
  };
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
}

bool sameSettings(const RenderSettings& a, const RenderSettings& b) { return metadataOf(a) == metadataOf(b); }

/// How many passes a picture at rest gets.
std::uint32_t passesOf(const RenderRequest& request) {
  return request.settings.frame.passes > 1 ? request.settings.frame.passes : request.view.refinePasses;
}

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

int draftDivisor(double fullMilliseconds, double milliseconds) {
  if (milliseconds <= 0 || fullMilliseconds <= milliseconds) return 1;
  return std::clamp(int(std::ceil(std::sqrt(fullMilliseconds / milliseconds))), 2, 4);
}

RenderLoop::RenderLoop(TraceScene& trace, const Job& job, std::function<void()> onPicture)
    : trace_(trace), job_(job), onPicture_(std::move(onPicture)), thread_([this] { run(); }) {}

RenderLoop::~RenderLoop() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
    stop_.request_stop();
  }
  wake_.notify_one();
  thread_.join();
}

std::uint64_t RenderLoop::show(RenderRequest request) {
  const std::lock_guard lock(mutex_);
  if (working_ != Work::kNone && outdates(request)) stop_.request_stop();
  wanted_ = std::move(request);
  wake_.notify_one();
  return ++asked_;
}

/// Whether what is being rendered is in vain once that is asked for.
bool RenderLoop::outdates(const RenderRequest& request) const {
  if (!sameSettings(request.settings, request_.settings)) return true;
  const bool same = sameView(request.camera, request_.camera) && sameLights(request.lights, request_.lights);
  if (working_ == Work::kPass) return !same || request.moving;
  return request.moving && draftDivisor(fullMilliseconds_, request.view.draftMilliseconds) > divisor_;
}

bool RenderLoop::take(RenderedPicture& picture) {
  const std::lock_guard lock(mutex_);
  if (!isNew_) return false;
  std::swap(ready_, picture);
  isNew_ = false;
  return true;
}

std::string RenderLoop::error() const {
  const std::lock_guard lock(mutex_);
  return error_;
}

std::vector<std::string> RenderLoop::warnings() const {
  const std::lock_guard lock(mutex_);
  return warnings_;
}

bool RenderLoop::idle() const {
  const std::lock_guard lock(mutex_);
  return !wanted_ && !isNew_ && working_ == Work::kNone && !wantsPass();
}

bool RenderLoop::wantsPass() const {
  if (!whole_ || request_.moving || !request_.view.refine || !error_.empty()) return false;
  const float seconds = request_.settings.frame.seconds;
  if (seconds > 0.0f && millisecondsSince(still_) > 1000.0 * double(seconds)) return false;
  return passes_ < passesOf(request_);
}

void RenderLoop::run() {
  std::unique_lock lock(mutex_);
  while (next(lock)) {
    const Work kind = working_;
    lock.unlock();
    std::string error;
    try {
      work(kind);
    } catch (const Error& stopped) {
      if (stopped.kind() != ErrorKind::kStopped) error = stopped.what();
    } catch (const std::bad_alloc&) {
      error = "memory does not suffice; a smaller picture or fewer photons would need less";
    } catch (const std::exception& other) {
      error = other.what();
    }
    lock.lock();
    working_ = Work::kNone;
    // A frame that was broken off for another request is not missed; a pass leaves what was there.
    if (error.empty()) continue;
    error_ = std::move(error);
    lock.unlock();
    onPicture_();
    lock.lock();
  }
}

bool RenderLoop::next(std::unique_lock<std::mutex>& lock) {
  for (;;) {
    wake_.wait(lock, [&] { return ending_ || wanted_ || wantsPass(); });
    if (ending_) return false;
    const Work work = wanted_ ? takeUp() : Work::kPass;
    if (work == Work::kNone) continue;
    working_ = work;
    stop_ = std::stop_source();
    return true;
  }
}

RenderLoop::Work RenderLoop::takeUp() {
  const bool settings = sameSettings(wanted_->settings, request_.settings);
  const bool same =
      settings && sameView(wanted_->camera, request_.camera) && sameLights(wanted_->lights, request_.lights);
  if (!settings) fullMilliseconds_ = 0;
  request_ = std::move(*wanted_);
  wanted_.reset();
  number_ = asked_;
  if (same && whole_ && error_.empty()) {
    // A motion has come to rest on a whole picture: that is refined.
    still_ = Clock::now();
    return wantsPass() ? Work::kPass : Work::kNone;
  }
  error_.clear();
  whole_ = false;
  divisor_ = request_.moving ? draftDivisor(fullMilliseconds_, request_.view.draftMilliseconds) : 1;
  return Work::kFrame;
}

void RenderLoop::work(Work kind) {
  if (kind == Work::kFrame)
    renderFrame();
  else
    refinePass();
}

Job RenderLoop::jobOfThis() {
  Job job;
  job.memoryBudgetBytes = job_.memoryBudgetBytes;
  job.stop = stop_.get_token();
  job.log = [this](LogLevel level, std::string_view message) {
    if (level != LogLevel::kWarning) return;
    const std::lock_guard lock(mutex_);
    warnings_.emplace_back(message);
  };
  return job;
}

CpuRenderer& RenderLoop::rendererOf(int divisor) {
  std::unique_ptr<CpuRenderer>& renderer = divisor == 1 ? full_ : draft_;
  RenderSettings settings = request_.settings;
  FrameSettings& frame = settings.frame;
  frame.width = std::max(1u, frame.width / std::uint32_t(divisor));
  frame.height = std::max(1u, frame.height / std::uint32_t(divisor));
  if (renderer && sameSettings(renderer->settings(), settings)) return *renderer;
  renderer.reset();  // Its memory serves the next.
  if (divisor == 1) refining_.reset();
  renderer = std::make_unique<CpuRenderer>(trace_, settings);
  return *renderer;
}

std::shared_ptr<Film> RenderLoop::freeFilm() {
  // Others let go of a film under the mutex (take()), so that what they read of it lies before this.
  const std::lock_guard lock(mutex_);
  for (const std::shared_ptr<Film>& film : films_)
    if (film.use_count() == 1) return film;
  return films_.emplace_back(std::make_shared<Film>());
}

void RenderLoop::renderFrame() {
  {
    const std::lock_guard lock(mutex_);
    warnings_.clear();
  }
  goesOn_ = false;
  frame_.reset();
  for (std::size_t i = 0; i < request_.lights.size(); ++i) trace_.setLight(i, request_.lights[i]);
  const auto start = Clock::now();
  const std::shared_ptr<Film> film = freeFilm();
  back_.stats = Stats();
  rendererOf(divisor_).render(request_.camera, *film, back_.stats, jobOfThis());
  radius_ = float(back_.stats.counter("radiusMetres"));
  frame_ = film;
  const double milliseconds = millisecondsSince(start);
  {
    const std::lock_guard lock(mutex_);
    const double full = milliseconds * divisor_ * divisor_;
    // A renderer's first frame takes longer, as it allocates.
    fullMilliseconds_ = fullMilliseconds_ > 0 ? 0.5 * (fullMilliseconds_ + full) : full;
    still_ = Clock::now();
  }
  publish(frame_, 1, divisor_, milliseconds);
}

void RenderLoop::refinePass() {
  if (!refining_) refining_ = std::make_unique<ProgressiveRenderer>(trace_, request_.settings);
  if (!goesOn_) refining_->resume(*frame_, 1, radius_);
  goesOn_ = true;
  const auto start = Clock::now();
  back_.stats = Stats();
  refining_->addPass(request_.camera, back_.stats, jobOfThis());
  const std::shared_ptr<Film> film = freeFilm();
  *film = refining_->film();
  publish(film, refining_->passes(), 1, millisecondsSince(start));
}

void RenderLoop::publish(std::shared_ptr<const Film> film, std::uint32_t passes, int divisor,
                         double milliseconds) {
  {
    const std::lock_guard lock(mutex_);
    back_.film = std::move(film);
    back_.passes = passes;
    back_.divisor = divisor;
    back_.milliseconds = milliseconds;
    back_.number = number_;
    passes_ = passes;
    whole_ = divisor == 1;
    std::swap(back_, ready_);
    back_.film.reset();
    isNew_ = true;
  }
  onPicture_();
}

}  // namespace isophote::viewer
