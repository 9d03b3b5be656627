// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/photon_trace.h"

#include "base/error.h"
#include "stages/photon_trace/path_block.h"
#include "stages/photon_trace/photon_shares.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <chrono>

namespace isophote {

namespace {

/// Hands progress on four times a second at most.
class ProgressGate {
 public:
  ProgressGate(const Job& job, std::size_t total) : job_(job), total_(total) {}

  void advance() {
    const std::size_t done = ++done_;
    if (!job_.progress) return;
    const auto now = std::chrono::steady_clock::now().time_since_epoch().count();
    auto last = lastReport_.load(std::memory_order_relaxed);
    using Period = std::chrono::steady_clock::period;
    const bool due = double(now - last) * Period::num / Period::den >= 0.25 || done == total_;
    if (due && lastReport_.compare_exchange_strong(last, now))
      job_.report("photon_trace", double(done) / double(total_));
  }

 private:
  const Job& job_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::atomic<std::chrono::steady_clock::rep> lastReport_{0};
};

}  // namespace

struct PhotonTrace::Memory {
  SobolTable sobol;
  std::vector<PathRange> ranges;
  std::vector<RangeOutput> outputs;  ///< As many as the longest run so far had ranges.
  tbb::enumerable_thread_specific<std::unique_ptr<PathBlock>> blocks{
      [] { return std::make_unique<PathBlock>(); }};

  void appendRanges(std::uint32_t light, std::uint32_t first, std::uint32_t end, const Job& job);
  std::uint64_t traceFrom(std::size_t firstRange, const PathTracing& tracing, const Job& job);
  void collect(const std::vector<std::uint32_t>& pathsOfLight, const In& in, PhotonMap& out);
};

/// Cuts paths [first, end) of a light at the borders of blocks.
void PhotonTrace::Memory::appendRanges(std::uint32_t light, std::uint32_t first, std::uint32_t end,
                                       const Job& job) {
  const std::uint64_t bytes = (std::uint64_t(end - first) / kPathsPerBlock + 2 + ranges.size()) *
                              (sizeof(PathRange) + sizeof(RangeOutput));
  if (bytes > job.memoryBudgetBytes)
    fail(ErrorKind::kResources, "photon_trace.photons",
         "{} paths do not fit the memory budget of {} MiB; emit fewer or raise the budget", end,
         job.memoryBudgetBytes >> 20);
  while (first < end) {
    const std::uint32_t count = std::min(kPathsPerBlock - first % kPathsPerBlock, end - first);
    ranges.push_back({light, first, count});
    first += count;
  }
}

/// Traces ranges[firstRange ..); returns how many photons those stored.
std::uint64_t PhotonTrace::Memory::traceFrom(std::size_t firstRange, const PathTracing& tracing,
                                             const Job& job) {
  if (outputs.size() < ranges.size()) outputs.resize(ranges.size());
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < firstRange; ++i) before += outputs[i].photons.size();
  std::atomic<std::uint64_t> stored{before};
  ProgressGate progress(job, ranges.size() - firstRange);
  tbb::parallel_for(firstRange, ranges.size(), [&](std::size_t i) {
    job.throwIfStopped();
    blocks.local()->trace(tracing, ranges[i], job, outputs[i]);
    stored += outputs[i].photons.size();
    // Each photon exists twice while the map is put together.
    if (stored * 2 * sizeof(Photon) > job.memoryBudgetBytes)
      fail(ErrorKind::kResources, "photon_trace.photons",
           "the photons do not fit the memory budget of {} MiB; emit fewer or raise the budget",
           job.memoryBudgetBytes >> 20);
    progress.advance();
  });
  return stored - before;
}

/// Puts the map together in the order of the ranges, and gives every photon its part of its light's power.
void PhotonTrace::Memory::collect(const std::vector<std::uint32_t>& pathsOfLight, const In& in,
                                  PhotonMap& out) {
  out.emitted = 0;
  out.hitsPerBounce.assign(std::size_t(in.bounces) + 1, 0);
  out.powerEmitted = out.powerAbsorbed = out.powerEscaped = out.powerEnded = 0;
  if (in.rays) in.rays->clear();
  std::vector<std::size_t> offsets(ranges.size() + 1, 0);
  for (std::size_t i = 0; i < ranges.size(); ++i) {
    const RangeOutput& part = outputs[i];
    const double scale = 1.0 / double(pathsOfLight[ranges[i].light]);
    offsets[i + 1] = offsets[i] + part.photons.size();
    out.emitted += ranges[i].count;
    out.powerEmitted += part.powerEmitted * scale;
    out.powerAbsorbed += part.powerAbsorbed * scale;
    out.powerEscaped += part.powerEscaped * scale;
    out.powerEnded += part.powerEnded * scale;
    for (std::size_t b = 0; b < out.hitsPerBounce.size(); ++b) out.hitsPerBounce[b] += part.hitsPerBounce[b];
    if (in.rays) in.rays->insert(in.rays->end(), part.rays.begin(), part.rays.end());
  }
  out.photons.resize(offsets.back());
  tbb::parallel_for(std::size_t(0), ranges.size(), [&](std::size_t i) {
    const float scale = 1.0f / float(pathsOfLight[ranges[i].light]);
    Photon* to = out.photons.data() + offsets[i];
    for (const Photon& photon : outputs[i].photons) {
      *to = photon;
      to->power *= scale;
      ++to;
    }
  });
}

PhotonTrace::PhotonTrace(PhotonTraceSettings settings)
    : settings_(settings), memory_(std::make_unique<Memory>()) {}
PhotonTrace::~PhotonTrace() = default;
PhotonTrace::PhotonTrace(PhotonTrace&&) noexcept = default;
PhotonTrace& PhotonTrace::operator=(PhotonTrace&&) noexcept = default;

void PhotonTrace::run(const In& in, PhotonMap& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("photon_trace");
  const std::vector<Light>& lights = in.trace.scene().lights;
  const PathTracing tracing{in.trace, memory_->sobol, in.seed, in.pass, in.bounces, in.rays != nullptr};
  const std::uint64_t wanted = settings_.photonsStored;
  // Where a number of stored photons is asked for, the first round finds out how many of them a path leaves.
  std::uint64_t paths = wanted > 0 ? std::max<std::uint64_t>(wanted / 8, kPathsPerBlock) : settings_.photons;
  std::uint64_t stored = 0;
  std::vector<std::uint32_t> pathsOfLight(lights.size(), 0);
  memory_->ranges.clear();
  while (true) {
    const std::size_t firstRange = memory_->ranges.size();
    const std::vector<std::uint32_t> shares = photonShares(lights, std::uint32_t(paths));
    for (std::uint32_t i = 0; i < lights.size(); ++i) {
      const std::uint32_t end = std::max(shares[i], pathsOfLight[i]);
      memory_->appendRanges(i, pathsOfLight[i], end, job);
      pathsOfLight[i] = end;
    }
    stored += memory_->traceFrom(firstRange, tracing, job);
    if (stored >= wanted || memory_->ranges.empty()) break;
    constexpr std::uint64_t kMostPaths = 4'000'000'000;
    const std::uint64_t hopeless = std::min(std::max<std::uint64_t>(64 * wanted, 1u << 20), kMostPaths);
    if (paths >= hopeless) {
      job.warn(fmt::format("photon_trace.photonsStored: {} paths stored only {} photons of {}", paths, stored,
                           wanted));
      break;
    }
    const double more = stored > 0 ? double(wanted - stored) * double(paths) / double(stored) : double(paths);
    paths =
        std::min(paths + std::max<std::uint64_t>(std::uint64_t(1.01 * more), kPathsPerBlock / 4), hopeless);
  }
  memory_->collect(pathsOfLight, in, out);

  stats.setCounter("photonsEmitted", double(out.emitted));
  stats.setCounter("photonsStored", double(out.photons.size()));
  stats.setCounter("hitsPerBounce", std::vector<double>(out.hitsPerBounce.begin(), out.hitsPerBounce.end()));
  stats.addBytes("photon_trace.photons", out.photons.capacity() * sizeof(Photon));
}

}  // namespace isophote
