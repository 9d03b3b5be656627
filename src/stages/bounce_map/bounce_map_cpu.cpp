// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/bounce_map/bounce_map.h"
#include "stages/photon_trace/hit_lanes.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>

namespace isophote {

namespace {

static_assert(kLightBlockPixels == kRaysPerPiece);

/// What one block of pixels left behind.
struct BlockOutput {
  std::vector<PathState> photons;
  std::uint64_t emitted = 0;
  std::uint64_t hits = 0;
  double powerEmitted = 0;
  double powerAbsorbed = 0;
  double powerEscaped = 0;
};

/// The working memory of one thread: the photons of a block side by side, and two groups of hits, of which
/// one waits for the memory that it has asked for while the other is shaded.
class BlockBounce {
 public:
  void run(const BounceMap::In& in, const PathRandom& random, const LightMap& map, const LightBlock& block,
           BlockOutput& out);

 private:
  void scatter(const TraceScene& trace, const PathRandom& random, HitLanes& lanes, BlockOutput& out);

  PathColumns paths_;
  std::array<std::uint32_t, kLightBlockPixels> hitOfSlot_;
  std::array<HitLanes, 2> lanes_;
  PrefetchQueue queue_;
};

void BlockBounce::run(const BounceMap::In& in, const PathRandom& random, const LightMap& map,
                      const LightBlock& block, BlockOutput& out) {
  const Light& light = in.trace.lights()[map.light];
  const LightView& view = in.samples.views[block.view];
  const Hit* const hits = in.samples.hits.data() + block.firstHit;
  out.photons.clear();
  out.emitted = out.hits = 0;
  out.powerEmitted = out.powerAbsorbed = out.powerEscaped = 0;
  std::uint32_t slots = 0, pixels = 0;
  forEachPixel(block, [&](std::uint32_t number, vec2 pixel) {
    const std::uint32_t hit = pixels++;
    EmittedPhoton photon = emitThroughPixel(light, view, pixel);
    photon.power *= map.powerScale;
    const float power = meanOf(photon.power);
    if (!(maxOf(photon.power) > 0.0f)) return;
    ++out.emitted;
    out.powerEmitted += double(power);
    if (!hits[hit].valid()) {
      out.powerEscaped += double(power);
      return;
    }
    hitOfSlot_[slots] = hit;
    paths_.path[slots] = block.firstPath + number;
    paths_.light[slots] = map.light;
    paths_.origin.set(slots, photon.origin);
    paths_.direction.set(slots, photon.direction);
    paths_.power.set(slots, photon.power);
    paths_.density[slots] = 1.0f;
    ++slots;
  });
  out.hits = slots;
  std::uint32_t groups = 0;
  for (std::uint32_t first = 0; first < slots; first += kHitLanes, ++groups) {
    HitLanes& lanes = lanes_[groups % 2];
    lanes.clear();
    for (std::uint32_t slot = first; slot < std::min(first + kHitLanes, slots); ++slot)
      lanes.add(in.trace, hits[hitOfSlot_[slot]], slot, queue_);
    queue_.ask(2 * kAskedAtOnce);
    if (groups > 0) scatter(in.trace, random, lanes_[(groups + 1) % 2], out);
  }
  if (groups > 0) scatter(in.trace, random, lanes_[(groups + 1) % 2], out);
}

void BlockBounce::scatter(const TraceScene& trace, const PathRandom& random, HitLanes& lanes,
                          BlockOutput& out) {
  lanes.place(trace, paths_, queue_);
  lanes.arrive(trace, queue_);
  lanes.scatter(random, 0);
  for (std::uint32_t i = 0; i < lanes.count; ++i) {
    out.powerAbsorbed += double(lanes.absorbed[i]);
    if (lanes.survives[i] == 0u) continue;
    out.photons.push_back({lanes.origin[i], lanes.density[i], lanes.direction[i], lanes.path[i],
                           lanes.power[i], lanes.light[i], lanes.medium[i]});
  }
}

}  // namespace

void addAccount(const BouncedPhotons& bounced, PhotonMap& map, Stats& stats) {
  double carried = 0;
  for (const PathState& photon : bounced.photons) carried += double(meanOf(photon.power));
  map.emitted += bounced.emitted - bounced.photons.size();
  if (!map.hitsPerBounce.empty()) map.hitsPerBounce[0] += bounced.hits;
  map.powerEmitted += bounced.powerEmitted - carried;
  map.powerAbsorbed += bounced.powerAbsorbed;
  map.powerEscaped += bounced.powerEscaped;
  stats.setCounter("photonsEmitted", double(map.emitted));
  stats.setCounter("hitsPerBounce", std::vector<double>(map.hitsPerBounce.begin(), map.hitsPerBounce.end()));
}

struct BounceMap::Memory {
  SobolTable sobol;
  PathRandom random{sobol};
  std::vector<BlockOutput> outputs;  ///< As many as the longest run so far had blocks.
  std::vector<std::uint32_t> mapOfBlock;
  tbb::enumerable_thread_specific<std::unique_ptr<BlockBounce>> blocks{
      [] { return std::make_unique<BlockBounce>(); }};

  void collect(std::size_t blockCount, BouncedPhotons& out);
};

void BounceMap::Memory::collect(std::size_t blockCount, BouncedPhotons& out) {
  out.emitted = out.hits = 0;
  out.powerEmitted = out.powerAbsorbed = out.powerEscaped = 0;
  std::vector<std::size_t> offsets(blockCount + 1, 0);
  for (std::size_t b = 0; b < blockCount; ++b) {
    const BlockOutput& part = outputs[b];
    offsets[b + 1] = offsets[b] + part.photons.size();
    out.emitted += part.emitted;
    out.hits += part.hits;
    out.powerEmitted += part.powerEmitted;
    out.powerAbsorbed += part.powerAbsorbed;
    out.powerEscaped += part.powerEscaped;
  }
  out.photons.resize(offsets.back());
  tbb::parallel_for(std::size_t(0), blockCount, [&](std::size_t b) {
    std::ranges::copy(outputs[b].photons, out.photons.begin() + std::ptrdiff_t(offsets[b]));
  });
}

BounceMap::BounceMap() : memory_(std::make_unique<Memory>()) {}
BounceMap::~BounceMap() = default;
BounceMap::BounceMap(BounceMap&&) noexcept = default;
BounceMap& BounceMap::operator=(BounceMap&&) noexcept = default;

void BounceMap::run(const In& in, BouncedPhotons& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("bounce_map");
  const LightSamples& samples = in.samples;
  Memory& memory = *memory_;
  memory.random.start(in.seed, in.pass, in.trace.lights().size());
  if (memory.outputs.size() < samples.blocks.size()) memory.outputs.resize(samples.blocks.size());
  memory.mapOfBlock.resize(samples.blocks.size());
  for (std::uint32_t m = 0; m < samples.maps.size(); ++m)
    std::fill_n(memory.mapOfBlock.begin() + samples.maps[m].firstBlock, samples.maps[m].blockCount, m);
  tbb::parallel_for(std::size_t(0), samples.blocks.size(), [&](std::size_t b) {
    if (job.stop.stop_requested()) return;
    const LightBlock& block = samples.blocks[b];
    const LightMap& map = samples.maps[memory.mapOfBlock[b]];
    memory.blocks.local()->run(in, memory.random, map, block, memory.outputs[b]);
  });
  job.throwIfStopped();
  memory.collect(samples.blocks.size(), out);
  stats.setCounter("bounce_map.photonsEmitted", double(out.emitted));
  stats.setCounter("bounce_map.photonsScattered", double(out.photons.size()));
  stats.peakBytes("bounce_map.photons", out.photons.capacity() * sizeof(PathState));
}

}  // namespace isophote
