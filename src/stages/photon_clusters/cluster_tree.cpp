// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/cluster_tree.h"

#include "math/lanes.h"

#include <algorithm>
#include <cmath>

namespace isophote::photon_clusters {
namespace {

// What all clusters below a node have in common.
constexpr std::uint8_t kHasBacks = 1;    ///< Photons that arrive on the back do not count.
constexpr std::uint8_t kAccepts = 2;     ///< Every photon on the front counts alike.
constexpr std::uint8_t kSomeAccept = 4;  ///< That of any cluster below, which has a narrow cone.
constexpr float kNever = 2.0f;
constexpr float kQuarterTurn = 1.5707f;

SHARED_FN std::uint32_t maskOf(bool holds) { return 0u - std::uint32_t(holds); }

/// Which of kWidth nodes a photon meets. Conservative: `touched` whenever a point of the bounds is within the
/// radius as WithinSphere computes it, `enclosed` only where all are.
template <int kWidth>
SHARED_FN void hitNodes(const Level& level, std::uint32_t first, const PhotonSphere& photon, NodeHits& hits) {
  const float* const lowerX = level.lowerX.data() + first;
  const float* const lowerY = level.lowerY.data() + first;
  const float* const lowerZ = level.lowerZ.data() + first;
  const float* const upperX = level.upperX.data() + first;
  const float* const upperY = level.upperY.data() + first;
  const float* const upperZ = level.upperZ.data() + first;
  const float* const axisX = level.axisX.data() + first;
  const float* const axisY = level.axisY.data() + first;
  const float* const axisZ = level.axisZ.data() + first;
  const float* const reject = level.reject.data() + first;
  const float* const accept = level.accept.data() + first;
  const vec3 p = photon.position;
  const vec3 wi = photon.direction;
  std::uint32_t touched = 0, enclosed = 0, accepted = 0;
  const float r2 = 1.0f / photon.inverseRadius2;
  const float reach2 = r2 * 1.0001f, hold2 = r2 * 0.9999f;
  for (int i = 0; i < kWidth; ++i) {
    const vec3 below = vec3(lowerX[i], lowerY[i], lowerZ[i]) - p;
    const vec3 above = vec3(upperX[i], upperY[i], upperZ[i]) - p;
    const vec3 outside = max(max(below, -above), vec3(0.0f));
    const vec3 farthest = max(-below, above);
    const float facing = dot(vec3(axisX[i], axisY[i], axisZ[i]), wi);
    const std::uint32_t bit = detail::kBits[std::size_t(i)];
    const float near2 = dot(outside, outside), far2 = dot(farthest, farthest);
    touched |= bit & maskOf(near2 <= reach2) & maskOf(facing >= -reject[i]);
    enclosed |= bit & maskOf(far2 <= hold2);
    accepted |= bit & maskOf(facing > accept[i]);
  }
  hits = {touched, enclosed, accepted};
}

SHARED_FN void hitBody(const Level& level, std::uint32_t first, std::uint32_t count,
                       const PhotonSphere& photon, NodeHits& hits) {
  if (count <= 16)
    hitNodes<16>(level, first, photon, hits);
  else
    hitNodes<32>(level, first, photon, hits);
  hits.touched &= 0xffffffffu >> (kNodeWidth - count);
}

ISOPHOTE_SIMD(hitWith, hitBody,
              (const Level& level, std::uint32_t first, std::uint32_t count, const PhotonSphere& photon,
               NodeHits& hits),
              (level, first, count, photon, hits))

void setBounds(Level& level, std::size_t node, const Bounds& b) {
  level.lowerX[node] = b.lower.x, level.lowerY[node] = b.lower.y, level.lowerZ[node] = b.lower.z;
  level.upperX[node] = b.upper.x, level.upperY[node] = b.upper.y, level.upperZ[node] = b.upper.z;
}

Bounds boundsOf(const Level& level, std::size_t node) {
  return {vec3(level.lowerX[node], level.lowerY[node], level.lowerZ[node]),
          vec3(level.upperX[node], level.upperY[node], level.upperZ[node])};
}

}  // namespace

HitFn hitFor(SimdLevel level) { return hitWithFor(level); }

void Level::resize(std::size_t nodes) {
  // A loop over 32 nodes may begin at the last one.
  for (auto* array :
       {&lowerX, &lowerY, &lowerZ, &upperX, &upperY, &upperZ, &axisX, &axisY, &axisZ, &reject, &accept})
    array->resize(nodes + kNodeWidth);
  for (auto* array : {&firstChild, &childMask, &parent, &samples}) array->resize(nodes);
  divides.resize(nodes);
  power.assign(nodes, vec3(0.0f));
  accepted.assign(nodes, 0);
}

void ClusterTree::build(const std::vector<Cluster>& clusters, bool cone, TrivialAccept trivial) {
  used_ = 0;
  if (clusters.empty()) return;
  buildClusters(clusters, trivial);
  setThresholds(levels_[0], cone, trivial);
  while (levels_[used_ - 1].size() > kNodeWidth) {
    const std::size_t below = used_ - 1;
    buildAbove(below);
    setThresholds(levels_[below + 1], cone, trivial);
  }
}

void ClusterTree::buildClusters(const std::vector<Cluster>& clusters, TrivialAccept trivial) {
  if (levels_.empty()) levels_.emplace_back();
  used_ = 1;
  Level& level = levels_[0];
  level.resize(clusters.size());
  keys_.resize(clusters.size());
  cones_.resize(clusters.size());
  kinds_.resize(clusters.size());
  for (std::size_t i = 0; i < clusters.size(); ++i) {
    const Cluster& c = clusters[i];
    setBounds(level, i, c.bounds);
    level.firstChild[i] = std::uint32_t(i);
    level.childMask[i] = 1u;
    level.samples[i] = std::uint32_t(std::popcount(c.lanes));
    keys_[i] = c.key;
    cones_[i] = c.cone;
    const bool accepts =
        c.kind.lambertian && !c.kind.transmits && (c.kind.flat || trivial == TrivialAccept::kAll);
    const bool some = accepts && c.cone.angle < kQuarterTurn;
    kinds_[i] = std::uint8_t((c.kind.transmits ? 0 : kHasBacks) | (accepts ? kAccepts : 0) |
                             (some ? kSomeAccept : 0));
  }
}

/// Groups the nodes of a level, the last one so far.
void ClusterTree::buildAbove(std::size_t below) {
  if (levels_.size() == below + 1) levels_.emplace_back();
  used_ = below + 2;
  keysBelow_.swap(keys_);
  conesBelow_.swap(cones_);
  kindsBelow_.swap(kinds_);
  keys_.clear();
  for (const std::uint64_t key : keysBelow_)
    if (keys_.empty() || keys_.back() != key >> kKeyBits) keys_.push_back(key >> kKeyBits);
  Level& from = levels_[below];
  Level& level = levels_[below + 1];
  level.resize(keys_.size());
  cones_.resize(keys_.size());
  kinds_.resize(keys_.size());
  std::size_t child = 0;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    const std::size_t first = child;
    Bounds bounds;
    vec3 sum(0.0f);
    std::uint32_t mask = 0, samples = 0;
    std::uint8_t kind = kHasBacks | kAccepts;  // And kSomeAccept where a child has it.
    for (; child < keysBelow_.size() && keysBelow_[child] >> kKeyBits == keys_[i]; ++child) {
      from.parent[child] = std::uint32_t(i);
      bounds.extend(boundsOf(from, child));
      mask |= 1u << (keysBelow_[child] & (kNodeWidth - 1));
      samples += from.samples[child];
      kind = std::uint8_t((kind & kindsBelow_[child]) | ((kind | kindsBelow_[child]) & kSomeAccept));
      sum += conesBelow_[child].axis;
    }
    Cone cone{sum * inversesqrt(max(dot(sum, sum), 1e-20f)), 0.0f};
    for (std::size_t c = first; c < child; ++c)
      cone.angle = max(cone.angle, conesBelow_[c].angle +
                                       std::acos(clamp(dot(cone.axis, conesBelow_[c].axis), -1.0f, 1.0f)));
    setBounds(level, i, bounds);
    level.firstChild[i] = std::uint32_t(first);
    level.childMask[i] = mask;
    level.samples[i] = samples;
    cones_[i] = cone;
    kinds_[i] = kind;
  }
}

/// From the cones of the level that was built last.
void ClusterTree::setThresholds(Level& level, bool cone, TrivialAccept trivial) const {
  constexpr float kMargin = 1e-3f;  // Of an arc cosine, and of the products compared.
  for (std::size_t i = 0; i < level.size(); ++i) {
    const bool narrow = cones_[i].angle < kQuarterTurn;
    const float threshold = std::sin(cones_[i].angle) + kMargin;
    level.axisX[i] = cones_[i].axis.x, level.axisY[i] = cones_[i].axis.y, level.axisZ[i] = cones_[i].axis.z;
    level.reject[i] = cone && narrow && (kinds_[i] & kHasBacks) != 0 ? threshold : kNever;
    level.divides[i] = trivial != TrivialAccept::kOff && (kinds_[i] & kSomeAccept) != 0 ? 1 : 0;
    level.accept[i] =
        trivial != TrivialAccept::kOff && narrow && (kinds_[i] & kAccepts) != 0 ? threshold : kNever;
  }
}

void ClusterTree::spreadPower() {
  for (std::size_t l = used_; l-- > 1;) {
    const Level& level = levels_[l];
    Level& below = levels_[l - 1];
    for (std::size_t node = 0; node < level.size(); ++node)
      for (std::uint32_t c = 0; c < level.childCount(node); ++c)
        below.power[level.firstChild[node] + c] += level.power[node];
  }
}

std::uint64_t ClusterTree::bytes() const {
  std::uint64_t bytes = 0;
  for (const Level& level : levels())
    bytes += level.size() * (11 * sizeof(float) + 5 * sizeof(std::uint32_t) + sizeof(vec3));
  return bytes;
}

}  // namespace isophote::photon_clusters
