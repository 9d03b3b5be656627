// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "isophote/renderer.h"

#include "api/content.h"
#include "render/cpu_renderer.h"
#include "render/progressive.h"
#include "render/reference.h"
#include "scene/light_place.h"

namespace isophote {

struct Renderer::Content {
  World world;
  int threads;
  std::unique_ptr<TraceScene> trace = nullptr;
  std::unique_ptr<CpuRenderer> renderer = nullptr;
  std::shared_ptr<Picture::Content> last = nullptr;
  std::unique_ptr<ProgressiveRenderer> refining = nullptr;
  View refinedView = {};
  Stats refinedStats = {};

  Picture render(const Camera& camera, const Job& job) {
    return api::guardedWith(threads, [&] {
      Stats stats;
      const RenderSettings& settings = renderer->settings();
      if (hasPasses(settings.frame)) {
        ProgressiveRenderer passes(*trace, settings);
        addPasses(passes, camera, settings.frame, stats, job);
        return api::pictureOf(passes.film(), stats);
      }
      // The memory of the last picture serves again once nobody else holds it.
      if (!last || last.use_count() > 1) last = std::make_shared<Picture::Content>();
      renderer->render(camera, last->film, stats, job);
      last->statsJson = stats.toJson();
      return Picture(last);
    });
  }

  Picture refine(const View& view, const Job& job) {
    return api::guardedWith(threads, [&] {
      if (!refining || !(view == refinedView)) {
        refining = std::make_unique<ProgressiveRenderer>(*trace, renderer->settings());
        refinedView = view;
        refinedStats = Stats();
      }
      refining->addPass(api::cameraOf(view), refinedStats, job);
      return api::pictureOf(refining->film(), refinedStats);
    });
  }

  const Light& light(std::size_t index) const {
    const std::size_t count = trace->lights().size();
    if (index >= count)
      failUsage("light", "there is no light {}; the world has {}, counted from 0", index, count);
    return trace->lights()[index];
  }

  void setLight(std::size_t index, const Light& changed) {
    trace->setLight(index, changed);
    refining.reset();  // What was gathered shows the light elsewhere.
  }
};

Renderer::Renderer(World world, const Settings& settings, int threads, const Job& job)
    : content_(std::make_unique<Content>(Content{std::move(world), threads})) {
  api::guardedWith(threads, [&] {
    content_->trace = std::make_unique<TraceScene>(content_->world.content().scene, job);
    content_->renderer = std::make_unique<CpuRenderer>(*content_->trace, settings.content().render);
  });
}

Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

Picture Renderer::render(std::string_view view, const Job& job) {
  return content_->render(findCamera(content_->world.content().scene, std::string(view)), job);
}

Picture Renderer::render(const View& view, const Job& job) {
  return content_->render(api::cameraOf(view), job);
}

Picture Renderer::refine(const View& view, const Job& job) { return content_->refine(view, job); }

void Renderer::moveLight(std::size_t light, Float3 position) {
  api::guarded(
      [&] { content_->setLight(light, movedLight(content_->light(light), api::vectorOf(position))); });
}

void Renderer::aimLight(std::size_t light, Float3 direction) {
  api::guarded([&] {
    const Bounds& bounds = content_->world.content().scene.bounds;
    content_->setLight(light, aimedLight(content_->light(light), api::vectorOf(direction), bounds));
  });
}

Picture renderReference(const World& world, const View& view, const ReferenceOptions& options,
                        const Job& job) {
  return api::guardedWith(options.threads, [&] {
    ReferenceSettings settings;
    const auto positive = [](int value, const char* what) {
      if (value < 1) failUsage(what, "must be at least 1, but is {}", value);
      return std::uint32_t(value);
    };
    settings.width = positive(options.width, "width");
    settings.height = positive(options.height, "height");
    settings.spp = positive(options.samplesPerPixel, "samplesPerPixel");
    if (options.bounces < 0) failUsage("bounces", "must not be negative, but is {}", options.bounces);
    settings.bounces = std::uint32_t(options.bounces);
    settings.indirectOnly = options.indirectOnly;
    settings.seed = options.seed;
    Stats stats;
    Film film = renderReference(world.content().scene, api::cameraOf(view), settings, stats, job);
    return api::pictureOf(std::move(film), stats);
  });
}

}  // namespace isophote
