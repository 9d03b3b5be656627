// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/photon_clusters.h"
#include "stages/photon_estimate/packed_samples.h"
#include "stages/photon_estimate/sphere_passes.h"
#include "stages/view_clusters/cluster_tree.h"
#include "stages/view_clusters/clusters.h"
#include "stages/view_clusters/photon_sift.h"
#include "stages/view_clusters/subtree_lists.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>

namespace isophote {

using namespace photon_estimate;
using namespace view_clusters;

namespace {

constexpr std::size_t kPhotonsPerPart = 4096;  ///< Of a subtree's, so that they stay in the cache.
constexpr std::size_t kAhead = 12;             ///< Photons asked for before they are needed: they lie apart.

struct Pairs {
  std::uint64_t read = 0;      ///< From any list.
  std::uint64_t untested = 0;  ///< Of them, from lists of enclosed nodes.
  std::uint64_t accepted = 0;
  std::uint64_t deepEntries = 0;
  PairCounts counts;
};

/// What one thread works with.
struct Workspace {
  PhotonWalk walk;
  std::vector<std::uint32_t> part;    ///< Photons of a list.
  PhotonColumns photons;              ///< Those that enter the walk.
  std::vector<PhotonSphere> spheres;  ///< Their copies, side by side.
  std::vector<vec3> power;            ///< By level: accepted by the node visited last and those above it.
  std::vector<std::vector<std::uint32_t>>
      enclosing;  ///< Photons of the subtree's root and of each node above.
  PackedSamples samples;
};

Alike alikeBy(TrivialAccept trivial) {
  if (trivial == TrivialAccept::kOff) return Alike::kNone;
  return trivial == TrivialAccept::kFlat ? Alike::kFlatDiffuse : Alike::kDiffuse;
}

/// Sums up the power of photons. Four sums side by side, so that one addition need not wait for the other.
class PowerSum {
 public:
  void add(std::span<const std::uint32_t> list, const PhotonSphere* spheres) {
    for (const std::uint32_t photon : list) sums_[count_++ % 4] += spheres[photon].weightedPower;
  }
  std::size_t count() const { return count_; }
  vec3 power() const { return (sums_[0] + sums_[1]) + (sums_[2] + sums_[3]); }

 private:
  vec3 sums_[4]{};
  std::size_t count_ = 0;
};

vec3 powerOf(std::span<const std::uint32_t> list, const PhotonSphere* spheres) {
  PowerSum sum;
  sum.add(list, spheres);
  return sum.power();
}

}  // namespace

struct PhotonClusters::Scratch {
  std::vector<PhotonSphere> spheres;  ///< Of the photons that are worked on.
  float radius2 = 0;
  Clusters clusters;
  ClusterTree tree;
  SubtreeLists shallow;
  bool ignoresShadingNormals = false;           ///< Of diffuse surfaces.
  std::vector<std::vector<vec3>> shallowPower;  ///< Of each level's nodes: accepted by them and those above.
  std::vector<Pairs> pairs;                     ///< Of each subtree.
  std::uint64_t shallowAccepted = 0;
  tbb::enumerable_thread_specific<Workspace> workspaces;

  void build(const In& in, const PhotonClustersSettings& settings);
  void sumAccepted();
  /// Adds the photons of all lists to the samples.
  void estimateAll(const In& in, Radiance& out, const Job& job);
  /// Adds the photons of one subtree, and those of the nodes above it, to its samples.
  void estimateSubtree(const In& in, std::uint32_t root, Radiance& out, const Job& job);
  /// Likewise of one part of its photons.
  void estimatePart(const In& in, std::uint32_t root, std::span<const std::uint32_t> photons, bool firstPart,
                    Workspace& work, Radiance& out, const Job& job);
  void gatherEnclosing(std::uint32_t root, Workspace& work);
  void estimateCluster(const In& in, std::uint32_t cluster, std::uint32_t root,
                       std::span<const std::uint32_t> touching, bool withShallow, Workspace& work,
                       Radiance& out);
  void tell(Stats& stats, std::uint64_t shallowEntries, std::uint32_t passes) const;
};

void PhotonClusters::Scratch::build(const In& in, const PhotonClustersSettings& settings) {
  clusters.build(in.view, settings.size, settings.cellDepth, in.simd);
  tree.build(clusters, settings.cone, alikeBy(settings.trivial));
  shallow.prepare(tree);
  radius2 = in.radius * in.radius;
  ignoresShadingNormals = settings.trivial == TrivialAccept::kAll;
  shallowPower.resize(tree.levels().size());
  pairs.assign(shallow.subtrees(), {});
  shallowAccepted = 0;
}

/// Sums up what the shallow nodes accepted in this sub-pass.
void PhotonClusters::Scratch::sumAccepted() {
  std::atomic<std::uint64_t> accepted = 0;
  for (std::size_t l = tree.levels().size(); l-- > shallow.rootLevel();) {
    const std::vector<Node>& nodes = tree.levels()[l].nodes;
    shallowPower[l].resize(nodes.size());
    tbb::parallel_for(std::uint32_t(0), std::uint32_t(nodes.size()), [&](std::uint32_t node) {
      const bool isTop = l + 1 == tree.levels().size();
      PowerSum sum;
      shallow.forEachPart(l, node, SubtreeLists::kAccepted, kPhotonsPerPart, workspaces.local().part,
                          [&](std::span<const std::uint32_t> photons) { sum.add(photons, spheres.data()); });
      shallowPower[l][node] = sum.power() + (isTop ? vec3(0.0f) : shallowPower[l + 1][nodes[node].parent]);
      accepted += std::uint64_t(sum.count()) * nodes[node].samples;
    });
  }
  shallowAccepted += accepted;
}

void PhotonClusters::Scratch::estimateAll(const In& in, Radiance& out, const Job& job) {
  std::atomic<std::size_t> done = 0;
  tbb::parallel_for(std::uint32_t(0), shallow.subtrees(), [&](std::uint32_t root) {
    estimateSubtree(in, root, out, job);
    const std::size_t now = ++done;
    if (now % 64 == 0) job.report("photon_clusters", double(now) / double(shallow.subtrees()));
  });
}

void PhotonClusters::Scratch::estimateSubtree(const In& in, std::uint32_t root, Radiance& out,
                                              const Job& job) {
  Workspace& work = workspaces.local();
  gatherEnclosing(root, work);
  bool firstPart = true;
  const auto estimate = [&](std::span<const std::uint32_t> photons) {
    estimatePart(in, root, photons, firstPart, work, out, job);
    firstPart = false;
  };
  shallow.forEachPart(shallow.rootLevel(), root, SubtreeLists::kTouching, kPhotonsPerPart, work.part,
                      estimate);
  if (firstPart) estimate({});
}

/// Copies the lists of a subtree's root and of the nodes above it, which all its clusters read.
void PhotonClusters::Scratch::gatherEnclosing(std::uint32_t root, Workspace& work) {
  work.enclosing.resize(std::max(work.enclosing.size(), tree.levels().size()));
  std::uint32_t node = root;
  for (std::size_t l = shallow.rootLevel(); l < tree.levels().size(); ++l) {
    std::vector<std::uint32_t>& list = work.enclosing[l];
    list.clear();
    shallow.forEachPart(l, node, SubtreeLists::kEnclosing, kPhotonsPerPart, work.part,
                        [&](std::span<const std::uint32_t> photons) {
                          list.insert(list.end(), photons.begin(), photons.end());
                        });
    node = tree.levels()[l].nodes[node].parent;
  }
}

void PhotonClusters::Scratch::estimatePart(const In& in, std::uint32_t root,
                                           std::span<const std::uint32_t> photons, bool firstPart,
                                           Workspace& work, Radiance& out, const Job& job) {
  const std::size_t rootLevel = shallow.rootLevel();
  work.walk.prepare(tree, photons.size(), radius2, in.simd);
  work.photons.reserve(photons.size());
  work.photons.count = 0;
  work.spheres.resize(photons.size());
  for (std::uint32_t i = 0; i < photons.size(); ++i) {
    if (i + kAhead < photons.size()) __builtin_prefetch(&spheres[photons[i + kAhead]]);
    work.spheres[i] = spheres[photons[i]];
    work.photons.push(work.spheres[i], i);
  }
  work.power.assign(rootLevel + 1, vec3(0.0f));
  work.power[rootLevel] = firstPart ? shallowPower[rootLevel][root] : vec3(0.0f);
  if (rootLevel == 0) return estimateCluster(in, root, root, work.photons.list(), firstPart, work, out);
  const Node& node = tree.levels()[rootLevel].nodes[root];
  work.walk.descend(
      rootLevel - 1, node.firstChild, node.childCount(), work.photons,
      [&](std::size_t level, std::uint32_t at, const Sifted& sifted) {
        job.throwIfStopped();
        work.power[level] = work.power[level + 1] + powerOf(sifted.acceptedList(), work.spheres.data());
        pairs[root].accepted += std::uint64_t(sifted.acceptedCount) * tree.levels()[level].nodes[at].samples;
        pairs[root].deepEntries += sifted.enclosingCount;
        if (level == 0) estimateCluster(in, at, root, sifted.touching.list(), firstPart, work, out);
        return true;
      });
}

void PhotonClusters::Scratch::estimateCluster(const In& in, std::uint32_t index, std::uint32_t root,
                                              std::span<const std::uint32_t> touching, bool withShallow,
                                              Workspace& work, Radiance& out) {
  const std::size_t rootLevel = shallow.rootLevel();
  const vec3 power = work.power[0];
  pairs[root].deepEntries += touching.size();
  for (const Patch& patch : clusters.patchesOf(index)) {
    SphereLoopKind kind = patch.kind;
    kind.flat |= ignoresShadingNormals;
    const SphereLoop enclosed = sphereLoopFor(kind, true, in.simd);
    PackedSamples& samples = work.samples;
    const ViewTile& tile = in.view.tiles[patch.tile];
    PairCounts counts, unused;
    std::size_t read = 0;
    const auto add = [&](SphereLoop loop, const PhotonSphere* from, std::span<const std::uint32_t> list,
                         PairCounts& felt) {
      if (list.empty()) return;
      if (read == 0) samples.pack(tile, patch.lanes, kind, power);
      read += list.size();
      runSphereLoop(loop, samples.tile(), from, list, samples.lanes(), samples.sums(), felt);
    };
    add(sphereLoopFor(kind, false, in.simd), work.spheres.data(), touching, counts);
    for (std::size_t l = 0; l < rootLevel; ++l)
      add(enclosed, work.spheres.data(), work.walk.step(l).enclosingList(), unused);
    for (std::size_t l = rootLevel; withShallow && l < tree.levels().size(); ++l)
      add(enclosed, spheres.data(), work.enclosing[l], unused);
    if (read == 0 && power == vec3(0.0f)) continue;
    if (read == 0) samples.pack(tile, patch.lanes, kind, power);
    samples.addRadianceTo(out[patch.tile]);
    const std::uint64_t count = std::uint64_t(std::popcount(patch.lanes));
    Pairs& sum = pairs[root];
    sum.read += read * count;
    sum.untested += (read - touching.size()) * count;
    sum.counts.felt += counts.felt;
    sum.counts.contributing += counts.contributing + unused.contributing;
  }
}

void PhotonClusters::Scratch::tell(Stats& stats, std::uint64_t shallowEntries, std::uint32_t passes) const {
  Pairs sum;
  for (const Pairs& p : pairs) {
    sum.read += p.read;
    sum.untested += p.untested;
    sum.accepted += p.accepted;
    sum.deepEntries += p.deepEntries;
    sum.counts.felt += p.counts.felt;
    sum.counts.contributing += p.counts.contributing;
  }
  std::vector<double> nodes;
  for (const Level& level : tree.levels()) nodes.push_back(double(level.size()));
  stats.setCounter("photon_clusters.pairsTested", double(sum.read));
  stats.setCounter("photon_clusters.pairsRejected", double(sum.read - sum.untested - sum.counts.felt));
  stats.setCounter("photon_clusters.pairsContributing", double(sum.counts.contributing));
  stats.setCounter("photon_clusters.pairsAccepted", double(sum.accepted + shallowAccepted));
  stats.setCounter("photon_clusters.nodes", std::move(nodes));
  stats.setCounter("photon_clusters.shallowEntries", double(shallowEntries));
  stats.setCounter("photon_clusters.deepEntries", double(sum.deepEntries));
  stats.setCounter("photon_clusters.subPasses", double(passes));
  stats.peakBytes("photon_clusters.photons", spheres.capacity() * sizeof(PhotonSphere));
  stats.peakBytes("photon_clusters.tree", tree.bytes() + clusters.bytes());
  stats.peakBytes("photon_clusters.lists", shallow.bytes());
}

PhotonClusters::PhotonClusters(PhotonClustersSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonClusters::~PhotonClusters() = default;
PhotonClusters::PhotonClusters(PhotonClusters&&) noexcept = default;
PhotonClusters& PhotonClusters::operator=(PhotonClusters&&) noexcept = default;

void PhotonClusters::run(const In& in, Radiance& out, Stats& stats, const Job& job) {
  Scratch& s = *scratch_;
  {
    const Stats::Scope scope = stats.scope("photon_clusters.build");
    s.build(in, settings_);
    out.resize(in.view.tiles.size());
    tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) { out[i] = {}; });
  }
  std::uint64_t entries = 0;
  std::uint32_t passes = 0;
  if (s.shallow.subtrees() > 0)
    passes = forEachSubPass(
        in.map.photons, in.radius, "photon_clusters.radius", s.spheres, job,
        [&](std::uint32_t first, std::uint64_t maxBytes) {
          const Stats::Scope scope = stats.scope("photon_clusters.shallow");
          const std::uint32_t taken = s.shallow.build(s.spheres, s.radius2, first, maxBytes, in.simd, job);
          s.sumAccepted();
          entries += s.shallow.entries();
          return taken;
        },
        [&](const Job& part) {
          const Stats::Scope scope = stats.scope("photon_clusters");
          s.estimateAll(in, out, part);
        });
  s.tell(stats, entries, passes);
}

}  // namespace isophote
