// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "math/rng.shared.h"
#include "stages/light_gbuffer/light_gbuffer.h"
#include "trace/light_views.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace isophote {

namespace {

/// Stands where random numbers are keyed by path: no pixel has it.
constexpr std::uint32_t kTurnPath = 0xffffffffu;

void appendBlocks(LightSamples& out, std::uint32_t view, std::uint32_t& blocksOfLight, std::size_t& hits) {
  const LightView& v = out.views[view];
  for (std::uint32_t y = 0; y < v.height; y += kLightBlockSide)
    for (std::uint32_t x = 0; x < v.width; x += kLightBlockSide) {
      const std::uint32_t width = std::min(kLightBlockSide, v.width - x);
      const std::uint32_t height = std::min(kLightBlockSide, v.height - y);
      out.blocks.push_back({view, x, y, width, height, blocksOfLight++ * kLightBlockPixels, hits});
      hits += std::size_t(width) * height;
    }
}

/// Lays out the views of all lights; returns the number of their pixels.
std::size_t layOut(const LightGbuffer::In& in, LightSamples& out, const Job& job) {
  const Bounds& bounds = in.trace.scene().bounds;
  const std::span<const Light> lights = in.trace.lights();
  out.maps.clear();
  out.views.clear();
  out.blocks.clear();
  std::size_t hits = 0;
  for (std::uint32_t i = 0; i < lights.size(); ++i) {
    const Light& light = lights[i];
    if (in.pixels[i] == 0 || !(light.power > 0.0f) || !hasLightViews(light)) continue;
    if (hits + in.pixels[i] > job.memoryBudgetBytes / sizeof(Hit))
      fail(ErrorKind::kResources, "photon_trace.photons",
           "the lights' views do not fit the memory budget of {} MiB; emit fewer photons or raise the budget",
           job.memoryBudgetBytes >> 20);
    const std::uint32_t key = pathKey(in.seed, in.pass, i, kTurnPath);
    const vec3 shift = random3(key, 0, 1);
    const auto firstView = std::uint32_t(out.views.size());
    const auto firstBlock = std::uint32_t(out.blocks.size());
    appendLightViews(light, i, bounds, lightViewFrame(light, random3(key, 0, 0)),
                     lightViewSide(light, bounds, in.pixels[i]), 0.0f, out.views);
    std::uint32_t blocks = 0;
    for (std::uint32_t view = firstView; view < out.views.size(); ++view) {
      out.views[view].subpixel = vec2(shift.x, shift.y);
      appendBlocks(out, view, blocks, hits);
    }
    out.maps.push_back({i, firstBlock, blocks, 0, 1.0f});
  }
  return hits;
}

/// Looks through the pixels of one block, 16 at a time; calls emit(photon) for each through which light
/// leaves.
template <class Emit>
void traceBlock(const TraceScene& trace, const LightView& view, const LightBlock& block, Hit* hits,
                const Emit& emit) {
  constexpr std::size_t kPacket = 16;
  const Light& light = trace.lights()[view.light];
  std::array<Ray, kPacket> rays;
  std::array<Hit*, kPacket> targets;
  std::array<Hit, kPacket> found;
  std::size_t count = 0;
  const auto flush = [&] {
    trace.closestHits(std::span(rays).first(count), std::span(found).first(count), true);
    for (std::size_t k = 0; k < count; ++k) *targets[k] = found[k];
    count = 0;
  };
  forEachPixel(block, [&](std::uint32_t, vec2 pixel) {
    const EmittedPhoton photon = emitThroughPixel(light, view, pixel);
    Hit* const target = hits++;
    *target = {};
    if (!(max(photon.power.x, max(photon.power.y, photon.power.z)) > 0.0f)) return;
    emit(photon);
    rays[count] = {photon.origin, 0.0f, photon.direction, 1e30f};
    targets[count] = target;
    if (++count == kPacket) flush();
  });
  flush();
}

}  // namespace

void LightGbuffer::run(const In& in, LightSamples& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("light_gbuffer");
  out.hits.resize(layOut(in, out, job));
  emitted_.assign(out.blocks.size(), {});
  tbb::parallel_for(std::size_t(0), out.blocks.size(), [&](std::size_t b) {
    if (job.stop.stop_requested()) return;
    const LightBlock& block = out.blocks[b];
    traceBlock(in.trace, out.views[block.view], block, out.hits.data() + block.firstHit,
               [&emitted = emitted_[b]](const EmittedPhoton& photon) {
                 ++emitted.photons;
                 emitted.power += double(photon.power.x + photon.power.y + photon.power.z) / 3.0;
               });
  });
  job.throwIfStopped();
  for (LightMap& map : out.maps) {
    double power = 0;
    for (std::uint32_t b = map.firstBlock; b < map.firstBlock + map.blockCount; ++b) {
      map.photons += emitted_[b].photons;
      power += emitted_[b].power;
    }
    const Light& light = in.trace.lights()[map.light];
    if (light.type == kLightSpot && power > 0) map.powerScale = float(double(light.power) / power);
  }
  stats.setCounter("light_gbuffer.pixels", double(out.hits.size()));
  stats.peakBytes("light_gbuffer.hits", out.hits.capacity() * sizeof(Hit));
}

}  // namespace isophote
