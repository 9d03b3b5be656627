// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isophote/picture.h"
#include "isophote/settings.h"
#include "isophote/world.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string_view>

namespace isophote {

/// Lights one world with photons, picture after picture: the ray tracing hierarchy and all buffers are kept
/// from one to the next. One thread at a time may use a renderer; different renderers are independent.
///
/// Work runs in the calling thread's TBB arena: call from inside `tbb::task_arena::execute` of your own to
/// share or to limit threads, or give `threads`.
class Renderer {
 public:
  /// Builds the hierarchy. `threads` limits how many work for this renderer; 0: as many as the arena has.
  /// Throws Error(kBadUsage) for settings that cannot go together, Error(kResources).
  Renderer(World world, const Settings& settings, int threads = 0, const Job& job = {});
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// One picture, of as many passes as the settings say: the world seen from one of its own views, by name;
  /// empty: the first. Throws Error(kBadUsage) that lists them, Error(kStopped) and Error(kResources); the
  /// renderer stays usable.
  Picture render(std::string_view view = {}, const Job& job = {});
  Picture render(const View& view, const Job& job = {});

  /// Adds a pass (as of the setting frame.passes) to the picture of that view and returns the mean of all so
  /// far, which converges. Another view than the last time starts anew. After an error the picture goes on
  /// from the passes before.
  Picture refine(const View& view, const Job& job = {});

  /// Puts a light of the world elsewhere [m], for this renderer's pictures from now on: a point or spot
  /// light, or a rectangle's middle. Costs nothing: the picture is that of a world with the light there.
  /// Throws Error(kBadUsage) where there is no such light (World::lightCount()), or it has no place of its
  /// own.
  void moveLight(std::size_t light, Float3 position);
  /// The same for the direction in which a spot or directional light shines.
  void aimLight(std::size_t light, Float3 direction);

 private:
  struct Content;
  std::unique_ptr<Content> content_;
};

/// What the path tracer is told.
struct ReferenceOptions {
  int width = 1280;
  int height = 720;
  int samplesPerPixel = 64;
  int bounces = 3;  ///< Indirect bounces, counted as the setting frame.bounces.
  bool indirectOnly = false;
  std::uint32_t seed = 0;
  int threads = 0;  ///< As Renderer's.
};

/// The same world, camera and light transport by unbiased path tracing: slow, and what all else is compared
/// with.
Picture renderReference(const World& world, const View& view, const ReferenceOptions& options = {},
                        const Job& job = {});

}  // namespace isophote
