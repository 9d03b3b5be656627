// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_trace/wavefront.h"

#include "base/error.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>

namespace isophote {

namespace {

template <class Vector>
void growTo(Vector& vector, std::size_t size) {
  if (vector.size() < size) vector.resize(size);
}

/// Likewise, to a capacity of `room` where the one that it has is too small.
template <class Vector>
void growTo(Vector& vector, std::size_t size, std::size_t room) {
  if (vector.capacity() < size) vector.reserve(std::max(size, room));
  growTo(vector, size);
}

}  // namespace

std::uint64_t Wavefront::bytes(std::uint64_t paths, bool footprints) {
  const std::size_t plain = 3 * sizeof(KeyedRay) + 2 * sizeof(PathState) + sizeof(Photon);
  const std::size_t more = footprints ? 2 * sizeof(PathDifferential) + sizeof(PhotonFootprint) : 0;
  return std::min<std::uint64_t>(paths, kMostPathsOfWave) * (plain + more);
}

void Wavefront::appendPieces(std::uint32_t first, std::uint32_t count, const PathRange* range) {
  for (std::uint32_t done = 0; done < count; done += kRaysPerPiece)
    pieces_.push_back({first + done, std::min(count - done, kRaysPerPiece), range});
}

void Wavefront::emit(const PathTracing& tracing, std::span<const PathRange> ranges, const Job& job,
                     WaveOutput& out) {
  pieces_.clear();
  for (const PathRange& range : ranges) appendPieces(range.slot, range.count, &range);
  if (pieces_.empty()) return;
  order_.resize(pieces_.back().first + pieces_.back().count);
  // Rays of different ranges stay apart, as pieces do.
  tbb::parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    const Piece& piece = pieces_[i];
    const std::span<KeyedRay> rays(&order_[piece.first], piece.count);
    keyFirstRays(tracing.random, *piece.range, piece.first, rays);
    const std::uint32_t rangeKey = std::uint32_t(piece.range - ranges.data()) << kFirstKeyBits;
    for (KeyedRay& ray : rays) ray.key |= rangeKey;
  });
  sort_.sort(order_, kFirstKeyBits + std::uint32_t(std::bit_width(ranges.size() - 1)));
  startWave(order_.size(), out);
  traceSegment(tracing, 0, {}, job, out);
  walk(tracing, 0, job, out);
}

void Wavefront::resume(const PathTracing& tracing, std::span<const PathState> starts, const Job& job,
                       WaveOutput& out) {
  order_.resize(starts.size());
  tbb::parallel_for(std::size_t(0), starts.size(), [&](std::size_t i) {
    order_[i] = {tracing.keys.key(starts[i].origin, starts[i].direction), std::uint32_t(i)};
  });
  sort_.sort(order_, RayKeys::kBits);
  pieces_.clear();
  appendPieces(0, std::uint32_t(order_.size()), nullptr);
  startWave(order_.size(), out);
  traceSegment(tracing, 1, starts, job, out);
  walk(tracing, 1, job, out);
}

void Wavefront::startWave(std::size_t paths, WaveOutput& out) {
  out.pathsToCome -= std::min<std::uint64_t>(paths, out.pathsToCome);
  pathsOfWave_ = paths;
  storedBefore_ = out.stored;
}

/// Goes on after that bounce.
void Wavefront::walk(const PathTracing& tracing, std::uint32_t bounce, const Job& job, WaveOutput& out) {
  while (orderSurvivors()) {
    std::swap(paths_, nextPaths_);
    std::swap(differentials_, nextDifferentials_);
    traceSegment(tracing, ++bounce, paths_, job, out);
  }
}

void Wavefront::traceSegment(const PathTracing& tracing, std::uint32_t bounce,
                             std::span<const PathState> paths, const Job& job, WaveOutput& out) {
  const std::size_t rays = order_.size();
  growTo(nextRays_, rays);
  growTo(nextPaths_, rays);
  growTo(photons_, rays);
  if (tracing.footprints()) {
    growTo(nextDifferentials_, rays);
    growTo(footprints_, rays);
  }
  growTo(results_, pieces_.size());
  tbb::parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    job.throwIfStopped();
    const Piece& piece = pieces_[i];
    PieceTracer& tracer = *tracers_.local();
    PieceResult& result = results_[i];
    result.clear();
    const std::span<const KeyedRay> order(&order_[piece.first], piece.count);
    if (piece.range)
      tracer.emit(tracing, *piece.range, order, result);
    else
      tracer.load(paths, order);
    PieceRoom room{&nextPaths_[piece.first], &nextRays_[piece.first], piece.first, &photons_[piece.first]};
    if (tracing.footprints()) {
      if (!piece.range) tracer.loadDifferentials(differentials_, order);
      room.differentials = &nextDifferentials_[piece.first];
      room.footprints = &footprints_[piece.first];
    }
    tracer.trace(tracing, bounce, room, result);
    out.ended(piece.count - result.survivors);
  });
  collect(tracing, bounce, job, out);
}

/// Adds what the pieces left to the map.
void Wavefront::collect(const PathTracing& tracing, std::uint32_t bounce, const Job& job, WaveOutput& out) {
  PhotonMap& map = out.map;
  std::uint64_t stored = out.stored;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    PieceResult& part = results_[i];
    part.firstStored = stored;
    stored += part.stored;
    map.hitsPerBounce[bounce] += part.hits;
    map.powerEmitted += part.powerEmitted;
    map.powerAbsorbed += part.powerAbsorbed;
    map.powerEscaped += part.powerEscaped;
    map.powerEnded += part.powerEnded;
    if (out.rays) out.rays->insert(out.rays->end(), part.rays.begin(), part.rays.end());
  }
  // Each photon exists twice while the map grows.
  const bool footprints = tracing.footprints();
  const std::size_t bytesOfPhoton = sizeof(Photon) + (footprints ? sizeof(PhotonFootprint) : 0);
  if (stored * 2 * bytesOfPhoton > job.memoryBudgetBytes)
    fail(ErrorKind::kResources, "photon_trace.photons",
         "the photons do not fit the memory budget of {} MiB; emit fewer or raise the budget",
         job.memoryBudgetBytes >> 20);
  const std::uint64_t room =
      std::min(foreseen(tracing, bounce, stored, out), job.memoryBudgetBytes / (2 * bytesOfPhoton));
  growTo(map.photons, stored, room);
  if (footprints) growTo(map.footprints, stored, room);
  tbb::parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    std::copy_n(&photons_[pieces_[i].first], results_[i].stored,
                map.photons.begin() + std::ptrdiff_t(results_[i].firstStored));
    if (footprints)
      std::copy_n(&footprints_[pieces_[i].first], results_[i].stored,
                  map.footprints.begin() + std::ptrdiff_t(results_[i].firstStored));
  });
  out.stored = stored;
}

/// How many photons the run will have stored in the end, after so many: further bounces store and leave the
/// same parts of the rays as this one, later waves store as this one does, and where a number is wanted, what
/// is emitted for it brings a little more.
std::uint64_t Wavefront::foreseen(const PathTracing& tracing, std::uint32_t bounce, std::uint64_t stored,
                                  const WaveOutput& out) const {
  constexpr double kMargin = 1.0625, kMostGrowth = 2;  // What comes may be unlike what came.
  double survivors = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) survivors += results_[i].survivors;
  const double rays = double(order_.size());
  const double storedOfRay = double(stored - out.stored) / rays, survivorsOfRay = survivors / rays;
  double ahead = 0;
  for (std::uint32_t b = bounce; b < tracing.bounces; ++b, survivors *= survivorsOfRay)
    ahead += survivors * storedOfRay;
  const double ofWave = double(stored - storedBefore_) + ahead;
  const double later = ofWave * double(out.pathsToCome) / double(pathsOfWave_);
  const double growth = std::min(kMargin * (ahead + later), kMostGrowth * double(stored));
  const std::uint64_t all = stored + std::uint64_t(growth);
  return all > out.wanted / 2 ? std::max(all, out.wanted + out.wanted / 64) : all;
}

/// Sorts the rays of the next segment and cuts them into pieces; returns whether there are any.
bool Wavefront::orderSurvivors() {
  std::uint32_t rays = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    results_[i].firstSurvivor = rays;
    rays += results_[i].survivors;
  }
  order_.resize(rays);
  tbb::parallel_for(std::size_t(0), pieces_.size(), [&](std::size_t i) {
    std::copy_n(&nextRays_[pieces_[i].first], results_[i].survivors,
                order_.begin() + results_[i].firstSurvivor);
  });
  sort_.sort(order_, RayKeys::kBits);
  pieces_.clear();
  appendPieces(0, rays, nullptr);
  return rays > 0;
}

}  // namespace isophote
