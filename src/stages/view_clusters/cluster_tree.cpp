// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/view_clusters/cluster_tree.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace isophote::view_clusters {
namespace {

constexpr std::uint8_t kHasBacks = 1;    ///< Photons that arrive on the back do not count.
constexpr std::uint8_t kAccepts = 2;     ///< Every photon on the front counts alike.
constexpr std::uint8_t kSomeAccept = 4;  ///< That of any cluster below, which has a narrow cone.
constexpr float kNever = 2.0f;
constexpr float kQuarterTurn = 1.5707f;

/// What clusters have in common, and kSomeAccept where one has it.
std::uint8_t together(std::uint8_t a, std::uint8_t b) {
  return std::uint8_t((a & b) | ((a | b) & kSomeAccept));
}

std::uint8_t kindOf(const Patch& patch, Alike alike) {
  const bool accepts = alike == Alike::kAll || (patch.kind.lambertian && !patch.kind.transmits &&
                                                (patch.kind.flat || alike == Alike::kDiffuse));
  return std::uint8_t((patch.kind.transmits ? 0 : kHasBacks) | (accepts ? kAccepts : 0) |
                      (accepts && patch.cone.angle < kQuarterTurn ? kSomeAccept : 0));
}

void setThresholds(Node& node, const Cone& around, std::uint8_t kind, bool cone, Alike alike) {
  constexpr float kMargin = 1e-3f;  // Of an arc cosine, and of the products compared.
  const bool narrow = around.angle < kQuarterTurn;
  const bool some = alike != Alike::kNone;
  const float threshold = std::sin(around.angle) + kMargin;
  node.axis = around.axis;
  node.reject = cone && narrow && (kind & kHasBacks) != 0 ? threshold : kNever;
  node.accept = some && narrow && (kind & kAccepts) != 0 ? threshold : kNever;
  node.divides = alike == Alike::kAll || (some && (kind & kSomeAccept) != 0) ? 1 : 0;
}

}  // namespace

void Level::resize(std::size_t count) {
  nodes.resize(count);
  keys.resize(count);
  cones.resize(count);
  kinds.resize(count);
}

bool Level::transmits(std::size_t node) const { return (kinds[node] & kHasBacks) == 0; }

void ClusterTree::build(const Clusters& clusters, bool cone, Alike alike) {
  used_ = 0;
  if (clusters.all().empty()) return;
  buildClusters(clusters, cone, alike);
  while (levels_[used_ - 1].size() > kNodeWidth) buildAbove(used_ - 1, cone, alike);
}

void ClusterTree::buildClusters(const Clusters& clusters, bool cone, Alike alike) {
  if (levels_.empty()) levels_.emplace_back();
  used_ = 1;
  Level& level = levels_[0];
  level.resize(clusters.all().size());
  tbb::parallel_for(std::size_t(0), level.size(), [&](std::size_t i) {
    const std::span<const Patch> patches = clusters.patchesOf(i);
    Node& node = level.nodes[i];
    node = {};
    node.firstChild = std::uint32_t(i);
    node.childMask = 1u;
    level.kinds[i] = kindOf(patches[0], alike);
    for (const Patch& patch : patches) {
      node.bounds.extend(patch.bounds);
      node.samples += std::uint32_t(std::popcount(patch.lanes));
      level.kinds[i] = together(level.kinds[i], kindOf(patch, alike));
    }
    level.keys[i] = clusters.all()[i].key;
    level.cones[i] = patches.size() == 1
                         ? patches[0].cone
                         : coneAround(patches.size(), [&](std::size_t p) { return patches[p].cone; });
    setThresholds(node, level.cones[i], level.kinds[i], cone, alike);
    node.divides = 0;
  });
}

/// Groups the nodes of a level, the last one so far.
void ClusterTree::buildAbove(std::size_t below, bool cone, Alike alike) {
  if (levels_.size() == below + 1) levels_.emplace_back();
  used_ = below + 2;
  Level& from = levels_[below];
  Level& level = levels_[below + 1];
  level.resize(0);
  for (std::size_t child = 0; child < from.size(); ++child) {
    const std::uint64_t key = from.keys[child] >> kKeyBits;
    if (level.keys.empty() || level.keys.back() != key) {
      level.keys.push_back(key);
      level.nodes.emplace_back().firstChild = std::uint32_t(child);
    }
    level.nodes.back().childMask |= 1u << (from.keys[child] & (kNodeWidth - 1));
  }
  level.resize(level.keys.size());
  tbb::parallel_for(std::size_t(0), level.size(), [&](std::size_t i) {
    Node& node = level.nodes[i];
    level.kinds[i] = from.kinds[node.firstChild];
    for (std::size_t c = node.firstChild; c < node.firstChild + node.childCount(); ++c) {
      from.nodes[c].parent = std::uint32_t(i);
      node.bounds.extend(from.nodes[c].bounds);
      node.samples += from.nodes[c].samples;
      level.kinds[i] = together(level.kinds[i], from.kinds[c]);
    }
    level.cones[i] = coneAround(
        node.childCount(), [&](std::size_t c) -> const Cone& { return from.cones[node.firstChild + c]; });
    setThresholds(node, level.cones[i], level.kinds[i], cone, alike);
  });
}

std::uint64_t ClusterTree::bytes() const {
  std::uint64_t bytes = 0;
  for (const Level& level : levels())
    bytes += level.size() * (sizeof(Node) + sizeof(std::uint64_t) + sizeof(Cone) + sizeof(std::uint8_t));
  return bytes;
}

}  // namespace isophote::view_clusters
