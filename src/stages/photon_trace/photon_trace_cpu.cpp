// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/photon_trace.h"

#include "base/error.h"
#include "stages/photon_trace/photon_shares.h"
#include "stages/photon_trace/wavefront.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <chrono>
#include <cmath>

namespace isophote {

namespace {

/// Hands progress on four times a second at most.
class ProgressGate {
 public:
  ProgressGate(const Job& job, std::size_t total) : job_(job), total_(total) {}

  void advance(std::size_t paths) {
    const std::size_t done = done_ += paths;
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

/// Where a number of stored photons is asked for, rounds of so many paths are emitted as it takes.
std::uint32_t pathsOfRound(const PhotonTraceSettings& settings) {
  constexpr std::uint32_t kFewest = 256;
  return settings.photonsStored > 0 ? std::max(settings.photonsStored / 64, kFewest) : settings.photons;
}

/// How many rounds there should be after `rounds` that stored `stored` photons of those wanted.
std::uint64_t roundsFor(std::uint64_t wanted, std::uint64_t stored, std::uint64_t rounds,
                        std::uint64_t mostRounds) {
  if (stored >= wanted) return rounds;
  // The first rounds foretell only roughly what further ones will store.
  const std::uint64_t most = std::min(8 * rounds, mostRounds);
  if (stored == 0) return most;
  const double needed = std::ceil(double(wanted) * double(rounds) / double(stored));
  return std::uint64_t(std::clamp(needed, double(rounds + 1), double(most)));
}

void scalePowers(PhotonMap& map, float factor) {
  for (double* sum : {&map.powerEmitted, &map.powerAbsorbed, &map.powerEscaped, &map.powerEnded})
    *sum *= double(factor);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, map.photons.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) map.photons[i].power *= factor;
  });
}

void scaleFootprints(PhotonMap& map, float factor) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, map.footprints.size(), 4096), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      map.footprints[i].axisX *= factor;
      map.footprints[i].axisY *= factor;
      map.footprints[i].spacing *= factor;
    }
  });
}

void clear(PhotonMap& map, std::uint32_t bounces) {
  map.emitted = 0;
  map.hitsPerBounce.assign(std::size_t(bounces) + 1, 0);
  map.powerEmitted = map.powerAbsorbed = map.powerEscaped = map.powerEnded = 0;
}

/// Paths [n * from / of, n * to / of) of n. More than n of them are rounds: of the sequence that goes on.
struct Share {
  std::uint64_t from, to, of;
  std::uint64_t begin(std::uint64_t n) const { return n * from / of; }
  std::uint64_t end(std::uint64_t n) const { return n * to / of; }
};

}  // namespace

struct PhotonTrace::Memory {
  SobolTable sobol;
  PathRandom random{sobol};
  Wavefront wavefront;
  std::vector<PathRange> ranges;
  std::vector<float> photonsOfLight;

  void emit(const PathTracing& tracing, std::span<const std::uint32_t> pathsOfLight, Share share,
            const Job& job, WaveOutput& out);
  void resume(const PathTracing& tracing, std::span<const PathState> starts, const Job& job, WaveOutput& out);
};

/// Emits a share of the n paths of every light, wave by wave.
void PhotonTrace::Memory::emit(const PathTracing& tracing, std::span<const std::uint32_t> pathsOfLight,
                               Share share, const Job& job, WaveOutput& out) {
  std::uint32_t room = kMostPathsOfWave;
  const auto flush = [&] {
    wavefront.emit(tracing, ranges, job, out);
    ranges.clear();
    room = kMostPathsOfWave;
  };
  ranges.clear();
  for (std::uint32_t light = 0; light < pathsOfLight.size(); ++light) {
    const std::uint64_t n = pathsOfLight[light];
    for (std::uint64_t first = share.begin(n); first < share.end(n);) {
      const std::uint32_t count = std::uint32_t(std::min<std::uint64_t>(share.end(n) - first, room));
      ranges.push_back({light, std::uint32_t(first), count, kMostPathsOfWave - room, 1.0f / float(n)});
      first += count;
      room -= count;
      if (room == 0 || ranges.size() == kMostRangesOfWave) flush();
    }
  }
  flush();
}

void PhotonTrace::Memory::resume(const PathTracing& tracing, std::span<const PathState> starts,
                                 const Job& job, WaveOutput& out) {
  double power = 0;
  for (const PathState& start : starts) power += double(meanOf(start.power));
  out.map.powerEmitted += power;
  if (tracing.bounces == 0) {
    out.map.powerEnded += power;
    out.ended(starts.size());
    return;
  }
  for (; !starts.empty(); starts = starts.subspan(std::min<std::size_t>(starts.size(), kMostPathsOfWave)))
    wavefront.resume(tracing, starts.first(std::min<std::size_t>(starts.size(), kMostPathsOfWave)), job, out);
}

PhotonTrace::PhotonTrace(PhotonTraceSettings settings)
    : settings_(settings), memory_(std::make_unique<Memory>()) {}
PhotonTrace::~PhotonTrace() = default;
PhotonTrace::PhotonTrace(PhotonTrace&&) noexcept = default;
PhotonTrace& PhotonTrace::operator=(PhotonTrace&&) noexcept = default;

void PhotonTrace::run(const In& in, PhotonMap& out, Stats& stats, const Job& job) {
  const auto scope = stats.scope("photon_trace");
  const Scene& scene = in.trace.scene();
  const std::uint64_t wanted = settings_.photonsStored;
  assert(in.batches == 1 || (wanted == 0 && in.starts.empty()));
  if (wanted > 0 && !in.starts.empty())
    failUsage("photon_trace.photonsStored",
              "other stages' photons go on here, which emit as many as they emit; set photons instead");
  std::vector<std::uint32_t> pathsOfLight(in.pathsOfLight.begin(), in.pathsOfLight.end());
  if (pathsOfLight.empty()) pathsOfLight = photonShares(in.trace.lights(), pathsOfRound(settings_));
  const Share batch{in.batch, std::uint64_t(in.batch) + 1, in.batches};
  std::uint64_t paths = 0;
  for (const std::uint64_t n : pathsOfLight) paths += batch.end(n) - batch.begin(n);
  if (in.footprints && !in.starts.empty())
    failUsage(
        "frame.firstBounce",
        "photons of a bounce map leave no footprints; set frame.firstBounce=traced, or another estimator");
  if (Wavefront::bytes(paths, in.footprints) > job.memoryBudgetBytes)
    fail(ErrorKind::kResources, "photon_trace.photons",
         "{} paths do not fit the memory budget of {} MiB; emit fewer or raise the budget", paths,
         job.memoryBudgetBytes >> 20);

  clear(out, in.bounces);
  if (in.rays) in.rays->clear();
  memory_->random.start(in.seed, in.pass, in.trace.lights().size());
  std::vector<float>& photonsOfLight = memory_->photonsOfLight;
  photonsOfLight.clear();
  if (in.footprints) photonsOfLight.assign(pathsOfLight.begin(), pathsOfLight.end());
  const PathTracing tracing{in.trace,   memory_->random,    RayKeys(scene.bounds),
                            in.bounces, in.rays != nullptr, photonsOfLight};
  WaveOutput waves{.map = out, .rays = in.rays, .ended = {}, .wanted = wanted};
  constexpr std::uint64_t kMostPaths = 4'000'000'000;
  const std::uint64_t hopeless = std::min(std::max<std::uint64_t>(64 * wanted, 1u << 20), kMostPaths);
  const std::uint64_t mostRounds = std::max<std::uint64_t>(hopeless / std::max<std::uint64_t>(paths, 1), 1);
  std::uint64_t rounds = 0;
  for (std::uint64_t next = 1; next > rounds; next = roundsFor(wanted, waves.stored, rounds, mostRounds)) {
    ProgressGate progress(job, (next - rounds) * paths + in.starts.size());
    waves.ended = [&](std::size_t ended) { progress.advance(ended); };
    waves.pathsToCome = (next - rounds) * paths + in.starts.size();
    memory_->emit(tracing, pathsOfLight, in.batches > 1 ? batch : Share{rounds, next, 1}, job, waves);
    memory_->resume(tracing, in.starts, job, waves);
    rounds = next;
  }
  if (waves.stored < wanted && paths > 0)
    job.warn(fmt::format("photon_trace.photonsStored: {} paths stored only {} photons of {}", rounds * paths,
                         waves.stored, wanted));
  out.photons.resize(waves.stored);
  out.footprints.resize(in.footprints ? waves.stored : 0);
  out.emitted = rounds * paths + in.starts.size();
  // Powers and footprints are those of one round so far.
  if (rounds > 1) {
    scalePowers(out, 1.0f / float(rounds));
    scaleFootprints(out, 1.0f / std::sqrt(float(rounds)));
  }

  stats.setCounter("photonsEmitted", double(out.emitted));
  stats.setCounter("photonsStored", double(out.photons.size()));
  stats.setCounter("hitsPerBounce", std::vector<double>(out.hitsPerBounce.begin(), out.hitsPerBounce.end()));
  stats.peakBytes("photon_trace.photons", out.photons.capacity() * sizeof(Photon));
  if (in.footprints)
    stats.peakBytes("photon_trace.footprints", out.footprints.capacity() * sizeof(PhotonFootprint));
}

}  // namespace isophote
