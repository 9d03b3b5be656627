// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What stands behind the handles of the public headers (include/isophote).
#pragma once

#include "base/error.h"
#include "base/stats.h"
#include "image/image.h"
#include "isophote/picture.h"
#include "isophote/settings.h"
#include "isophote/world.h"
#include "render/settings.h"
#include "scene/scene.h"

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <new>
#include <string>
#include <utility>

namespace isophote {

struct World::Content {
  Scene scene;
};

struct Settings::Content {
  RenderSettings render;
};

struct Picture::Content {
  Film film;
  std::string statsJson;
};

namespace api {

inline vec3 vectorOf(Float3 v) { return {v[0], v[1], v[2]}; }
inline Float3 arrayOf(vec3 v) { return {v.x, v.y, v.z}; }

Camera cameraOf(const View& view);

inline Picture pictureOf(Film film, const Stats& stats) {
  return Picture(std::make_shared<const Picture::Content>(Picture::Content{std::move(film), stats.toJson()}));
}

/// Nothing but Error leaves the library: runs `work` and turns what else is thrown into one.
template <class Work>
auto guarded(Work&& work) -> decltype(work()) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::kResources, "",
         "memory does not suffice; a smaller picture, fewer photons or a simpler scene would need less");
  } catch (const std::exception& error) {
    fail(ErrorKind::kInternal, "", "{}", error.what());
  }
}

/// guarded(work) with at most so many threads; 0: in the calling thread's arena.
template <class Work>
auto guardedWith(int threads, Work&& work) -> decltype(work()) {
  if (threads < 0 || threads > 4096) failUsage("threads", "must be 0 (all) to 4096, but is {}", threads);
  return guarded([&] {
    if (threads == 0) return work();
    // More than there are processors would be no faster, and TBB would say so on the terminal.
    tbb::task_arena arena(std::min(threads, tbb::info::default_concurrency()));
    return arena.execute(work);
  });
}

}  // namespace api
}  // namespace isophote
