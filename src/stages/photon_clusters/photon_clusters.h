// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/job.h"
#include "base/stats.h"
#include "math/simd.h"
#include "settings/visit.h"
#include "stages/gbuffer/view_samples.h"
#include "stages/photon_trace/photon_map.h"
#include "stages/view_clusters/cluster_size.h"

#include <memory>

namespace isophote {

/// Where a photon that every sample of a node feels alike is added to the node instead of to each sample.
enum class TrivialAccept : std::uint32_t { kOff, kFlat, kAll };
template <>
struct EnumNames<TrivialAccept> {
  static constexpr std::array names{"off", "flat", "all"};
};

struct PhotonClustersSettings {
  float radius = 0;
  ClusterSize size = ClusterSize::k8x8;
  float cellDepth = 1;
  bool cone = true;
  TrivialAccept trivial = TrivialAccept::kFlat;

  void visit(auto&& v) {
    v("radius", radius,
      {.help = "Radius in which a photon is felt, the same for all; 0: automatic.",
       .unit = "m",
       .min = 0,
       .max = 1e6});
    v("size", size,
      {.help = "Pixels of a cell of the view frustum. Changes no picture, only how long it takes."});
    v("cellDepth", cellDepth,
      {.help = "Depth of a cell of the view frustum over its width.", .min = 0.25, .max = 1e6});
    v("cone", cone,
      {.help = "Leave out photons that arrive on the back of all surfaces of a node, by its cone of normals. "
               "Changes no picture; not applied where light goes through the surface."});
    v("trivial", trivial,
      {.help = "Add a photon to a node as a whole where all its surfaces feel it alike: diffuse ones inside "
               "its sphere, facing it. off: never; flat: where the shading normals are the geometric ones, "
               "which changes no picture; all: on all diffuse surfaces, where shading normals then "
               "count for nothing. Never where the reflection depends on the view."});
  }
};

/// Radiance estimate by a hierarchy over clusters of view samples (VSCH): the view frustum is divided into
/// cells of a few pixels; the samples of one cell are a cluster, and clusters are the leaves of a tree, 32
/// children a node, with tight bounds and cones of normals. A sample reads the photons on the lists of its
/// leaf, testing distances, and those of all nodes above that lie within a photon's sphere as a whole,
/// without. Kernel 1 / (pi r^2), full BSDF. What is seen in mirrors and through glass is in the tree too.
///
/// A first, shallow pass leaves photons on lists at the nodes of the upper levels. Then each subtree below is
/// one piece of work: a node picks from its parent's list what it meets, 16 photons at a time, and hands it
/// to its children, so that deep lists are gone before they leave the cache. (VSCH follows each photon down
/// the tree, counts, and inserts it into lists: on a CPU three times the time, as every photon takes other
/// branches.)
///
/// Photons count as in PhotonVolumes. The same bytes come out at any number of threads and any instruction
/// set; a smaller memory budget adds up in another order.
class PhotonClusters {
 public:
  struct In {
    const ViewSamples& view;
    const PhotonMap& map;
    float radius;  ///< Resolved: settings.radius, or the automatic one [m].
    SimdLevel simd = bestSimdLevel();
  };

  explicit PhotonClusters(PhotonClustersSettings settings);
  ~PhotonClusters();
  PhotonClusters(PhotonClusters&&) noexcept;
  PhotonClusters& operator=(PhotonClusters&&) noexcept;

  /// out[i] belongs to in.view.tiles[i]; overwritten, memory reused. Where the photons' spheres, or the lists
  /// of the shallow pass, would take more than a part of the memory budget, the photons are worked off in
  /// several sub-passes. Stats: stages photon_clusters.build, .shallow, photon_clusters (within subtrees, and
  /// the estimate); counters (of photon_clusters.) pairsTested (pairs of a view sample and a photon that it
  /// reads from a list), pairsRejected (of them, farther apart than the radius), pairsContributing (where the
  /// photon adds light, by a list), pairsAccepted (where it does so by a node as a whole), nodes (by level,
  /// the clusters first), shallowEntries, deepEntries (of lists), subPasses.
  void run(const In& in, Radiance& out, Stats& stats, const Job& job = {});

 private:
  struct Scratch;
  PhotonClustersSettings settings_;
  std::unique_ptr<Scratch> scratch_;
};

}  // namespace isophote
