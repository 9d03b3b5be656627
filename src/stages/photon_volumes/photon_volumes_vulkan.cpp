// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/photon_volumes_vulkan.h"

#include "gpu/command_list.h"
#include "shaders/photon_volumes.h"
#include "stages/photon_estimate/photon_bins.h"
#include "stages/photon_volumes/photon_volumes.shared.h"
#include "stages/photon_volumes/volumes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <optional>

namespace isophote {

using namespace photon_estimate;
using namespace photon_volumes;

namespace {

// The device works on windows of blocks, for a part of each block's photons at a time. So no buffer can grow
// beyond what every device binds, however many photons meet however many tiles.
constexpr std::size_t kWindowBlocks = 64;
constexpr std::size_t kWindowTiles = kWindowBlocks * kNodeWidth;
constexpr std::uint64_t kGuaranteedBufferBytes = std::uint64_t(1) << 27;  ///< Vulkan's maxStorageBufferRange.
static_assert(kWindowTiles * sizeof(ViewTile) <= kGuaranteedBufferBytes);
static_assert(kWindowTiles * kPhotonsPerPart * sizeof(std::uint32_t) <= kGuaranteedBufferBytes);
static_assert(kWindowTiles <= 65535, "Vulkan guarantees no more workgroups a dispatch");

/// A device array that is made anew only to grow.
template <class T>
class GrowingArray {
 public:
  explicit GrowingArray(const char* name) : name_(name) {}
  GpuArray<T>& atLeast(GpuDevice& device, std::size_t count) {
    if (!array_ || array_->size() < count) {
      array_.reset();  // First, so that both never take memory at once.
      array_.emplace(device, name_, std::max<std::size_t>(count, 1));
    }
    return *array_;
  }
  std::uint64_t bytes() const { return array_ ? array_->bytes() : 0; }

 private:
  const char* name_;
  std::optional<GpuArray<T>> array_;
};

}  // namespace

struct PhotonVolumesVulkan::Engine {
  Engine(GpuDevice& gpu, PhotonVolumesSettings s)
      : device(gpu), settings(s), pipeline(gpu, "photon_volumes", shaders::photon_volumes) {}

  void run(const PhotonVolumes::In& in, Radiance& out, Stats& stats, const Job& job);
  void startWindow(const ViewSamples& view, std::size_t firstBlock);
  void makeLists(const PhotonVolumes::In& in, std::size_t firstBlock, std::size_t part,
                 std::uint32_t firstPhoton);
  void dispatch(bool first, bool last);
  void endWindow(Radiance& out);
  /// Parts that the busiest block of the window needs for its photons of this pass; at least 1.
  std::size_t partsOfWindow(std::size_t firstBlock) const;
  std::size_t blocksOfWindow(std::size_t firstBlock) const {
    return std::min(kWindowBlocks, blocks.size() - firstBlock);
  }

  GpuDevice& device;
  PhotonVolumesSettings settings;
  ComputePipeline pipeline;

  // On the host.
  std::vector<PhotonVolume> volumes;
  TileBlocks blocks;
  PhotonBins bins;
  std::vector<BlockLists<PhotonVolume>> lists;  ///< Of each block of the window.
  std::vector<std::uint32_t> windowTiles;  ///< Indices into the view's tiles, in the order of the device's.
  std::vector<ViewTile> tiles;             ///< Copies of them.
  std::vector<std::uint32_t> listBegin, list;
  std::vector<RadianceTile> radiance;
  std::vector<std::uint32_t> contributing;

  // On the device.
  GrowingArray<ViewTile> tilesOnDevice{"photon_volumes.viewTiles"};
  GrowingArray<PhotonVolume> volumesOnDevice{"photon_volumes.volumes"};
  GrowingArray<std::uint32_t> listBeginOnDevice{"photon_volumes.listBegin"};
  GrowingArray<std::uint32_t> listOnDevice{"photon_volumes.list"};
  GrowingArray<RadianceTile> radianceOnDevice{"photon_volumes.radiance"};
  GrowingArray<std::uint32_t> contributingOnDevice{"photon_volumes.contributing"};

  std::uint64_t pairsTested = 0;
  std::uint64_t pairsContributing = 0;
  double deviceMilliseconds = 0;
};

void PhotonVolumesVulkan::Engine::startWindow(const ViewSamples& view, std::size_t firstBlock) {
  windowTiles.clear();
  for (std::size_t b = 0; b < blocksOfWindow(firstBlock); ++b)
    for (const std::uint32_t tile : blocks.tiles(firstBlock + b))
      if (tile != kNoTile) windowTiles.push_back(tile);
  tiles.resize(windowTiles.size());
  for (std::size_t i = 0; i < tiles.size(); ++i) tiles[i] = view.tiles[windowTiles[i]];
  tilesOnDevice.atLeast(device, tiles.size()).upload(tiles);
}

std::size_t PhotonVolumesVulkan::Engine::partsOfWindow(std::size_t firstBlock) const {
  std::size_t most = 1;
  for (std::size_t b = 0; b < blocksOfWindow(firstBlock); ++b)
    most = std::max(most, bins.photons(firstBlock + b).size());
  return (most + kPhotonsPerPart - 1) / kPhotonsPerPart;
}

void PhotonVolumesVulkan::Engine::makeLists(const PhotonVolumes::In& in, std::size_t firstBlock,
                                            std::size_t part, std::uint32_t firstPhoton) {
  const auto photonsOf = [&](std::size_t b) {
    const std::span<const std::uint32_t> all = bins.photons(firstBlock + b);
    const std::size_t from = std::min(part * kPhotonsPerPart, all.size());
    return all.subspan(from, std::min(kPhotonsPerPart, all.size() - from));
  };
  const std::size_t count = blocksOfWindow(firstBlock);
  lists.resize(std::max(lists.size(), count));
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    lists[b].build(blocks.bounds(firstBlock + b), volumes, photonsOf(b), touchFor(in.simd));
  });
  listBegin.assign(1, 0);
  std::vector<std::size_t> firstTile(count);
  for (std::size_t b = 0; b < count; ++b) {
    firstTile[b] = listBegin.size() - 1;
    for (int slot = 0; slot < kNodeWidth; ++slot) {
      const std::uint32_t tile = blocks.tiles(firstBlock + b)[std::size_t(slot)];
      if (tile == kNoTile) continue;
      const std::size_t length = lists[b].list(slot).size();
      listBegin.push_back(listBegin.back() + std::uint32_t(length));
      pairsTested += std::uint64_t(length) * in.view.tiles[tile].count;
    }
  }
  list.resize(listBegin.back());
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t b) {
    // Empty slots have empty lists, so a block's lists lie one after the other.
    const std::span<const std::uint32_t> photons = photonsOf(b);
    std::uint32_t* next = list.data() + listBegin[firstTile[b]];
    for (int slot = 0; slot < kNodeWidth; ++slot)
      for (const std::uint32_t i : lists[b].list(slot)) *next++ = photons[i] - firstPhoton;
  });
}

void PhotonVolumesVulkan::Engine::dispatch(bool first, bool last) {
  GpuArray<std::uint32_t>& begin = listBeginOnDevice.atLeast(device, listBegin.size());
  GpuArray<std::uint32_t>& entries = listOnDevice.atLeast(device, list.size());
  GpuArray<RadianceTile>& sums = radianceOnDevice.atLeast(device, tiles.size());
  GpuArray<std::uint32_t>& hits = contributingOnDevice.atLeast(device, tiles.size());
  begin.upload(listBegin);
  entries.upload(list);

  CommandList commands(device, "photon_volumes");
  if (first) {
    commands.fill(sums, 0);
    commands.fill(hits, 0);
    commands.barrier();
  }
  {
    const auto scope = commands.scope("photon_volumes");
    commands.use(pipeline);
    commands.bind(kBindViewTiles, tilesOnDevice.atLeast(device, tiles.size()));
    commands.bind(kBindVolumes, volumesOnDevice.atLeast(device, 1));
    commands.bind(kBindListBegin, begin);
    commands.bind(kBindList, entries);
    commands.bind(kBindRadiance, sums);
    commands.bind(kBindContributing, hits);
    commands.push(PhotonVolumesPush{uint(settings.kernel), last ? 1u : 0u});
    commands.dispatch({std::uint32_t(tiles.size()), 1, 1});
  }
  for (const ScopeTime& time : commands.submitAndWait()) deviceMilliseconds += time.milliseconds;
}

void PhotonVolumesVulkan::Engine::endWindow(Radiance& out) {
  radiance.resize(tiles.size());
  contributing.resize(tiles.size());
  const Buffer& sums = radianceOnDevice.atLeast(device, tiles.size());
  const Buffer& hits = contributingOnDevice.atLeast(device, tiles.size());
  sums.download(std::as_writable_bytes(std::span(radiance)));
  hits.download(std::as_writable_bytes(std::span(contributing)));
  for (std::size_t i = 0; i < windowTiles.size(); ++i) {
    out[windowTiles[i]] = radiance[i];
    pairsContributing += contributing[i];
  }
}

void PhotonVolumesVulkan::Engine::run(const PhotonVolumes::In& in, Radiance& out, Stats& stats,
                                      const Job& job) {
  const Stats::Scope scope = stats.scope("photon_volumes");
  pairsTested = pairsContributing = 0;
  deviceMilliseconds = 0;
  out.resize(in.view.tiles.size());
  makeVolumes(in.map, in.radius, settings, volumes);
  blocks.build(in.view);

  const std::uint64_t volumeLimit = device.facts().maxStorageBufferBytes / sizeof(PhotonVolume);
  const std::size_t perPass = std::size_t(
      std::min<std::uint64_t>(PhotonBins::photonsWithin(job.memoryBudgetBytes, blocks.size()), volumeLimit));
  const std::size_t passes = std::max<std::size_t>(1, (volumes.size() + perPass - 1) / perPass);
  const auto startPass = [&](std::size_t pass) {
    const std::size_t first = pass * perPass;
    const std::size_t count = std::min(perPass, volumes.size() - first);
    bins.build(blocks, volumes, std::uint32_t(first), std::uint32_t(count), touchFor(in.simd));
    volumesOnDevice.atLeast(device, count).upload(std::span(volumes).subspan(first, count));
  };
  if (passes == 1) startPass(0);
  for (std::size_t block = 0; block < blocks.size(); block += kWindowBlocks) {
    startWindow(in.view, block);
    for (std::size_t pass = 0; pass < passes; ++pass) {
      if (passes > 1) startPass(pass);
      const std::size_t parts = partsOfWindow(block);
      for (std::size_t part = 0; part < parts; ++part) {
        job.throwIfStopped();
        makeLists(in, block, part, std::uint32_t(pass * perPass));
        dispatch(pass == 0 && part == 0, pass + 1 == passes && part + 1 == parts);
      }
    }
    endWindow(out);
    job.report("photon_volumes", double(block + blocksOfWindow(block)) / double(blocks.size()));
  }
  stats.setCounter("photon_volumes.pairsTested", double(pairsTested));
  stats.setCounter("photon_volumes.pairsContributing", double(pairsContributing));
  stats.setCounter("photon_volumes.deviceMilliseconds", deviceMilliseconds);
  stats.peakBytes("photon_volumes.device", tilesOnDevice.bytes() + volumesOnDevice.bytes() +
                                               listBeginOnDevice.bytes() + listOnDevice.bytes() +
                                               radianceOnDevice.bytes() + contributingOnDevice.bytes());
}

PhotonVolumesVulkan::PhotonVolumesVulkan(GpuDevice& device, PhotonVolumesSettings settings)
    : engine_(std::make_unique<Engine>(device, settings)) {}
PhotonVolumesVulkan::~PhotonVolumesVulkan() = default;
PhotonVolumesVulkan::PhotonVolumesVulkan(PhotonVolumesVulkan&&) noexcept = default;
PhotonVolumesVulkan& PhotonVolumesVulkan::operator=(PhotonVolumesVulkan&&) noexcept = default;

void PhotonVolumesVulkan::run(const PhotonVolumes::In& in, Radiance& out, Stats& stats, const Job& job) {
  engine_->run(in, out, stats, job);
}

}  // namespace isophote
