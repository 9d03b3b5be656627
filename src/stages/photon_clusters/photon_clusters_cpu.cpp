// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_clusters/cluster_tree.h"
#include "stages/photon_clusters/clusters.h"
#include "stages/photon_clusters/packed_samples.h"
#include "stages/photon_clusters/photon_clusters.h"
#include "stages/photon_clusters/subtree_lists.h"
#include "stages/photon_estimate/photon_lists.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>

namespace isophote {

using namespace photon_estimate;
using namespace photon_clusters;

namespace {

constexpr std::uint64_t kLargestLists = std::uint64_t(256) << 20;  ///< Of the shallow pass [bytes].
constexpr std::uint64_t kBudgetShare = 8;       ///< They take at most this part of the budget.
constexpr std::size_t kLargestDeep = 1u << 20;  ///< Entries of the deep pass, each thread.

struct Pairs {
  std::uint64_t read = 0;      ///< From any list.
  std::uint64_t untested = 0;  ///< Of them, from lists of enclosed nodes.
  std::uint64_t deepEntries = 0;
  PairCounts counts;
};

/// What one thread works with.
struct Workspace {
  SubtreeLists lists;
  PackedSamples samples;
};

/// The lists of the shallow pass: of nodes from the subtrees' roots up.
enum ShallowList : std::uint32_t { kEnclosing, kAccepted, kTouching, kShallowLists };

}  // namespace

struct PhotonClusters::Scratch {
  std::vector<PhotonSphere> spheres;
  Clusters clusters;
  ClusterTree tree;
  PhotonLists shallow;
  bool ignoresShadingNormals = false;  ///< Of diffuse surfaces.
  std::size_t rootLevel = 0;           ///< Of the subtrees.
  std::vector<std::uint32_t>
      shallowBase;  ///< Of each level: the number of its first node among shallow ones.
  std::uint32_t shallowNodes = 0;
  std::vector<Pairs> pairs;  ///< Of each subtree.
  tbb::enumerable_thread_specific<Workspace> workspaces;

  std::size_t listOf(std::size_t level, std::uint32_t node, ShallowList which) const {
    return std::size_t(shallowBase[level] + node) * kShallowLists + which;
  }
  std::size_t subtrees() const { return tree.levels().empty() ? 0 : tree.levels()[rootLevel].size(); }

  void build(const In& in, const PhotonClustersSettings& settings) {
    clusters.build(in.view, settings.cellDepth, in.simd);
    tree.build(clusters.all(), settings.cone, settings.trivial);
    ignoresShadingNormals = settings.trivial == TrivialAccept::kAll;
    const auto levels = tree.levels();
    rootLevel = levels.empty() ? 0 : std::min(kDeepLevels, levels.size() - 1);
    shallowBase.assign(levels.size(), 0);
    shallowNodes = 0;
    for (std::size_t l = rootLevel; l < levels.size(); ++l) {
      shallowBase[l] = shallowNodes;
      shallowNodes += std::uint32_t(levels[l].size());
    }
    pairs.assign(subtrees(), {});
  }

  /// Leaves photons at enclosed nodes above the subtrees and at the subtrees that they may reach.
  std::uint32_t leaveAtSubtrees(std::uint32_t first, std::uint64_t bytes, HitFn hit) {
    const std::size_t top = tree.levels().size() - 1;
    const std::uint32_t width = std::uint32_t(tree.levels()[top].size());
    return shallow.build(
        first, std::uint32_t(spheres.size()), std::size_t(shallowNodes) * kShallowLists, bytes,
        [&](std::uint32_t photon, auto&& visit) {
          tree.descend(
              hit, spheres[photon], top, 0, width, rootLevel,
              [&](std::size_t level, std::uint32_t node, bool accepted) {
                visit(listOf(level, node, accepted ? kAccepted : kEnclosing));
              },
              [&](std::size_t level, std::uint32_t node) { visit(listOf(level, node, kTouching)); });
        });
  }

  /// Sums up what the shallow nodes accepted.
  void sumAccepted() {
    for (std::size_t l = rootLevel; l < tree.levels().size(); ++l) {
      Level& level = tree.levels()[l];
      tbb::parallel_for(std::uint32_t(0), std::uint32_t(level.size()), [&](std::uint32_t node) {
        const std::span<const std::uint32_t> photons = shallow.photons(listOf(l, node, kAccepted));
        for (const std::uint32_t photon : photons) level.power[node] += spheres[photon].weightedPower;
        level.accepted[node] += std::uint32_t(photons.size());
      });
    }
  }

  /// Adds the photons of one subtree, and those of the nodes above it, to its samples.
  void estimateSubtree(const In& in, std::uint32_t root, std::size_t maxEntries, Radiance& out,
                       const Job& job);
  void estimateCluster(const In& in, std::uint32_t cluster, std::uint32_t root, bool withShallow,
                       Workspace& work, Radiance& out);
  /// Turns what has been summed up into radiance.
  void finish(const In& in, Radiance& out);
  void tell(Stats& stats, std::uint64_t shallowEntries, std::uint32_t passes) const;
};

void PhotonClusters::Scratch::estimateSubtree(const In& in, std::uint32_t root, std::size_t maxEntries,
                                              Radiance& out, const Job& job) {
  Workspace& work = workspaces.local();
  work.lists.start(tree, rootLevel, root);
  std::span<const std::uint32_t> photons = shallow.photons(listOf(rootLevel, root, kTouching));
  const HitFn hit = hitFor(in.simd);
  bool firstPart = true;
  do {
    job.throwIfStopped();
    photons = photons.subspan(work.lists.take(hit, spheres, photons, maxEntries));
    pairs[root].deepEntries += work.lists.entries();
    for (std::uint32_t c = work.lists.firstCluster(); c < work.lists.endCluster(); ++c) {
      job.throwIfStopped();
      estimateCluster(in, c, root, firstPart, work, out);
    }
    firstPart = false;
  } while (!photons.empty());
}

void PhotonClusters::Scratch::estimateCluster(const In& in, std::uint32_t index, std::uint32_t root,
                                              bool withShallow, Workspace& work, Radiance& out) {
  const Cluster& cluster = clusters.all()[index];
  SphereLoopKind kind = cluster.kind;
  kind.flat |= ignoresShadingNormals;
  const SphereLoop within = sphereLoopFor(kind, false, in.simd);
  const SphereLoop enclosed = sphereLoopFor(kind, true, in.simd);
  PackedSamples& samples = work.samples;
  PairCounts counts, unused;
  std::size_t read = 0, untested = 0;
  const auto add = [&](SphereLoop loop, const PhotonSphere* from, std::span<const std::uint32_t> list,
                       PairCounts& felt) {
    if (list.empty()) return;
    if (read == 0) samples.pack(cluster, in.view.tiles[cluster.tile]);
    read += list.size();
    runSphereLoop(loop, samples.tile(), from, list, samples.lanes(), samples.sums(), felt);
  };
  add(within, work.lists.spheres().data(), work.lists.touching(index), counts);
  const std::size_t tested = read;
  std::uint32_t node = index;
  for (std::size_t l = 0; l < rootLevel; node = tree.levels()[l++].parent[node])
    add(enclosed, work.lists.spheres().data(), work.lists.enclosing(l, node), unused);
  node = root;
  for (std::size_t l = rootLevel; withShallow; node = tree.levels()[l++].parent[node]) {
    add(enclosed, spheres.data(), shallow.photons(listOf(l, node, kEnclosing)), unused);
    if (l + 1 == tree.levels().size()) break;
  }
  if (read == 0) return;
  samples.addTo(out[cluster.tile]);
  untested = read - tested;
  const std::uint64_t count = std::uint64_t(std::popcount(cluster.lanes));
  Pairs& sum = pairs[root];
  sum.read += read * count;
  sum.untested += untested * count;
  sum.counts.felt += counts.felt;
  sum.counts.contributing += counts.contributing + unused.contributing;
}

void PhotonClusters::Scratch::finish(const In& in, Radiance& out) {
  tree.spreadPower();
  const std::vector<Cluster>& all = clusters.all();
  tbb::parallel_for(std::size_t(0), all.size(), [&](std::size_t i) {
    const vec3 power = tree.levels()[0].power[i];
    if (power == vec3(0.0f)) return;
    RadianceTile& sums = out[all[i].tile];
    for (std::uint64_t left = all[i].lanes; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      sums.r[lane] += power.x;
      sums.g[lane] += power.y;
      sums.b[lane] += power.z;
    }
  });
  tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) {
    if (in.view.tiles[i].lambertian != 0) lambertianRadiance(in.view.tiles[i], out[i]);
  });
}

void PhotonClusters::Scratch::tell(Stats& stats, std::uint64_t shallowEntries, std::uint32_t passes) const {
  Pairs sum;
  for (const Pairs& p : pairs) {
    sum.read += p.read;
    sum.untested += p.untested;
    sum.deepEntries += p.deepEntries;
    sum.counts.felt += p.counts.felt;
    sum.counts.contributing += p.counts.contributing;
  }
  std::vector<double> nodes;
  double accepted = 0;
  for (const Level& level : tree.levels()) {
    nodes.push_back(double(level.size()));
    for (std::size_t i = 0; i < level.size(); ++i)
      accepted += double(level.accepted[i]) * double(level.samples[i]);
  }
  stats.setCounter("photon_clusters.pairsTested", double(sum.read));
  stats.setCounter("photon_clusters.pairsRejected", double(sum.read - sum.untested - sum.counts.felt));
  stats.setCounter("photon_clusters.pairsContributing", double(sum.counts.contributing));
  stats.setCounter("photon_clusters.pairsAccepted", accepted);
  stats.setCounter("photon_clusters.nodes", std::move(nodes));
  stats.setCounter("photon_clusters.shallowEntries", double(shallowEntries));
  stats.setCounter("photon_clusters.deepEntries", double(sum.deepEntries));
  stats.setCounter("photon_clusters.subPasses", double(passes));
  stats.peakBytes("photon_clusters.photons", spheres.size() * sizeof(PhotonSphere));
  stats.peakBytes("photon_clusters.tree", tree.bytes() + clusters.all().size() * sizeof(Cluster));
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
    makeSpheres(in.map, in.radius, "photon_clusters.radius", s.spheres);
    s.build(in, settings_);
    out.resize(in.view.tiles.size());
    tbb::parallel_for(std::size_t(0), out.size(), [&](std::size_t i) { out[i] = {}; });
  }
  const std::uint32_t total = s.subtrees() > 0 ? std::uint32_t(s.spheres.size()) : 0;
  const std::uint64_t bytes = std::min(kLargestLists, job.memoryBudgetBytes / kBudgetShare);
  const std::size_t deep = std::min<std::size_t>(kLargestDeep, bytes / 16);
  std::uint64_t entries = 0;
  std::uint32_t passes = 0;
  for (std::uint32_t first = 0; first < total; ++passes) {
    job.throwIfStopped();
    std::uint32_t taken = 0;
    {
      const Stats::Scope scope = stats.scope("photon_clusters.shallow");
      taken = s.leaveAtSubtrees(first, bytes, hitFor(in.simd));
      s.sumAccepted();
      entries += s.shallow.entries();
    }
    const Stats::Scope scope = stats.scope("photon_clusters");
    std::atomic<std::size_t> done = 0;
    tbb::parallel_for(std::uint32_t(0), std::uint32_t(s.subtrees()), [&](std::uint32_t root) {
      s.estimateSubtree(in, root, deep, out, job);
      const double share = double(++done) / double(s.subtrees());
      if (done % 64 == 0)
        job.report("photon_clusters", (double(first) + share * double(taken)) / double(total));
    });
    first += taken;
  }
  const Stats::Scope scope = stats.scope("photon_clusters");
  s.finish(in, out);
  s.tell(stats, entries, passes);
}

}  // namespace isophote
