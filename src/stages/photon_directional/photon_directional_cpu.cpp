// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_directional/leaf_light.h"
#include "stages/photon_directional/leaf_sums.h"
#include "stages/photon_directional/photon_directional.h"
#include "stages/photon_estimate/sphere_passes.h"
#include "stages/view_clusters/cluster_tree.h"
#include "stages/view_clusters/clusters.h"
#include "stages/view_clusters/photon_sift.h"
#include "stages/view_clusters/subtree_lists.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>

namespace isophote {

using namespace photon_estimate;
using namespace view_clusters;
using namespace photon_directional;

namespace {

constexpr std::size_t kPhotonsPerPart = 4096;  ///< Of a subtree's, so that they stay in the cache.
constexpr std::size_t kAhead = 12;             ///< Photons asked for before they are needed: they lie apart.
constexpr float kNarrow = 0.1f;                ///< Angle up to which the normals of a leaf count as one.
constexpr float kLeastSeen = 1e-4f;            ///< Part of an octant below which a leaf does not see it.

/// Of one node, by octant.
using Flux = std::array<vec3, kOctants>;

struct Pairs {
  std::uint64_t tested = 0, contributing = 0, accepted = 0;
};

/// The samples that one leaf has in one tile.
struct PatchOfTile {
  std::uint64_t lanes;
  std::uint32_t leaf;
  bool flat;
};

/// What one thread works with.
struct Workspace {
  PhotonWalk walk;
  PhotonColumns photons;                ///< Those of one octant that enter the walk.
  std::vector<std::uint32_t> part;      ///< Photons of a list.
  std::vector<std::uint32_t> byOctant;  ///< The same, octant by octant.
};

/// Weighted power of photons, by their places in the columns.
vec3 powerOf(std::span<const std::uint32_t> list, const PhotonColumns& photons) {
  vec3 sum(0.0f);
  for (const std::uint32_t i : list)
    sum += vec3(photons.components[6][i], photons.components[7][i], photons.components[8][i]);
  return sum;
}

/// Of the widest cells of which at least `cells` lie across the picture; of the narrowest where it has too
/// few pixels.
ClusterSize cellSize(int width, std::uint32_t cells) {
  const auto fit = [=](int pixels) { return width / pixels >= int(cells); };
  return fit(32)   ? ClusterSize::k32x32
         : fit(16) ? ClusterSize::k16x16
         : fit(8)  ? ClusterSize::k8x8
                   : ClusterSize::k4x4;
}

OctantRule ruleOf(OctantWeights weights, const CameraRays& camera) {
  OctantRule rule{};
  rule.published = weights == OctantWeights::kPublished;
  rule.right = normalize(camera.right);
  rule.up = normalize(camera.up);
  rule.back = -camera.forward;
  for (uint o = 0; o < uint(kOctants); ++o) {
    const vec3 signs = octantSigns(o);
    rule.middles[o] = normalize(rule.right * signs.x + rule.up * signs.y + rule.back * signs.z);
  }
  return rule;
}

}  // namespace

struct PhotonDirectional::Scratch {
  OctantRule rule{};
  std::vector<PhotonSphere> spheres;  ///< Of the photons that are worked on.
  std::vector<std::uint8_t> octants;  ///< Of each.
  float radius = 0;
  Clusters clusters;
  ClusterTree tree;
  SubtreeLists shallow;
  std::size_t leafLevel = 0;
  std::vector<std::vector<Flux>> flux;  ///< By level from the leaves' on, and node: what each got itself.
  std::vector<LeafShape> shapes;
  std::vector<std::uint32_t> firstCluster;  ///< Of each leaf, and the end.
  std::vector<LeafLight> lights;            ///< Of each leaf.
  std::vector<std::uint32_t> tileBegin;     ///< Of each tile in `patches`, and the end.
  std::vector<PatchOfTile> patches;
  std::vector<Pairs> pairs;  ///< Of each subtree.
  std::uint64_t shallowAccepted = 0;
  tbb::enumerable_thread_specific<Workspace> workspaces;

  bool isNarrow(std::uint32_t leaf) const { return leaves().cones[leaf].angle < kNarrow; }
  const Level& leaves() const { return tree.levels()[leafLevel]; }

  void build(const In& in, const PhotonDirectionalSettings& settings);
  void findClustersOfLeaves();
  void sortPatchesByTile(std::size_t tiles);
  std::uint32_t fillLists(std::uint32_t first, std::uint64_t maxBytes, SimdLevel simd, const Job& job);
  /// Adds what nodes above the subtrees accepted.
  void addShallow();
  void addSubtrees(SimdLevel simd, const Job& job);
  void addPart(std::uint32_t root, std::span<const std::uint32_t> photons, SimdLevel simd, Workspace& work);
  void addLeaf(std::uint32_t leaf, std::uint32_t octant, const PhotonColumns& from, SimdLevel simd,
               Pairs& count);
  /// Hands the flux of nodes down to the leaves.
  void makeLights(const ViewSamples& view, SimdLevel simd);
  void findSeen(const ViewSamples& view, std::uint32_t leaf, SimdLevel simd);
  void shade(const In& in, Radiance& irradiance, Radiance& reflectance, const Job& job) const;
  void shadeTile(const ViewTile& tile, std::size_t index, SimdLevel simd, RadianceTile& irradiance,
                 RadianceTile& reflectance) const;
  void tell(Stats& stats, std::uint32_t passes) const;
};

void PhotonDirectional::Scratch::build(const In& in, const PhotonDirectionalSettings& settings) {
  rule = ruleOf(settings.weights, in.view.camera);
  radius = in.radius;
  clusters.build(in.view, cellSize(in.view.width, settings.cells), settings.cellDepth, in.simd, true);
  tree.build(clusters, true, Alike::kAll);
  const std::size_t levels = tree.levels().size();
  leafLevel = levels == 0 ? 0 : std::min<std::size_t>(settings.level, levels - 1);
  shallow.prepare(tree, leafLevel);
  shallowAccepted = 0;
  pairs.assign(shallow.subtrees(), {});
  flux.resize(std::max(flux.size(), levels));
  for (std::size_t l = leafLevel; l < levels; ++l) flux[l].assign(tree.levels()[l].size(), Flux{});
  tileBegin.assign(in.view.tiles.size() + 1, 0);
  if (levels == 0) return;
  shapes.resize(leaves().size());
  tbb::parallel_for(std::size_t(0), shapes.size(), [&](std::size_t i) {
    shapes[i] = leafShape(leaves().nodes[i], leaves().cones[i], leaves().transmits(i), radius);
  });
  findClustersOfLeaves();
  sortPatchesByTile(in.view.tiles.size());
}

void PhotonDirectional::Scratch::findClustersOfLeaves() {
  firstCluster.resize(leaves().size() + 1);
  tbb::parallel_for(std::size_t(0), leaves().size(), [&](std::size_t leaf) {
    std::uint32_t node = std::uint32_t(leaf);
    for (std::size_t l = leafLevel; l > 0; --l) node = tree.levels()[l].nodes[node].firstChild;
    firstCluster[leaf] = node;
  });
  firstCluster.back() = std::uint32_t(clusters.all().size());
}

void PhotonDirectional::Scratch::sortPatchesByTile(std::size_t tiles) {
  for (const Patch& patch : clusters.patches()) ++tileBegin[patch.tile + 1];
  for (std::size_t t = 0; t < tiles; ++t) tileBegin[t + 1] += tileBegin[t];
  patches.resize(clusters.patches().size());
  for (std::uint32_t leaf = 0; leaf < leaves().size(); ++leaf)
    for (std::uint32_t c = firstCluster[leaf]; c < firstCluster[leaf + 1]; ++c)
      for (const Patch& patch : clusters.patchesOf(c))
        patches[tileBegin[patch.tile]++] = {patch.lanes, leaf, patch.kind.flat};
  // Each place has moved on to the next tile's.
  std::copy_backward(tileBegin.begin(), tileBegin.end() - 1, tileBegin.end());
  tileBegin[0] = 0;
}

std::uint32_t PhotonDirectional::Scratch::fillLists(std::uint32_t first, std::uint64_t maxBytes,
                                                    SimdLevel simd, const Job& job) {
  if (first == 0) {
    octants.resize(spheres.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, spheres.size(), 4096), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i)
        octants[i] = std::uint8_t(rule.octant(spheres[i].direction));
    });
  }
  return shallow.build(spheres, radius * radius, first, maxBytes, simd, job);
}

void PhotonDirectional::Scratch::addShallow() {
  std::atomic<std::uint64_t> accepted = 0;
  for (std::size_t l = shallow.rootLevel(); l < tree.levels().size(); ++l)
    tbb::parallel_for(std::uint32_t(0), std::uint32_t(tree.levels()[l].size()), [&](std::uint32_t node) {
      shallow.forEachPart(l, node, SubtreeLists::kAccepted, kPhotonsPerPart, workspaces.local().part,
                          [&](std::span<const std::uint32_t> photons) {
                            for (const std::uint32_t photon : photons)
                              flux[l][node][octants[photon]] += spheres[photon].weightedPower;
                            accepted += photons.size();
                          });
    });
  shallowAccepted += accepted;
}

void PhotonDirectional::Scratch::addSubtrees(SimdLevel simd, const Job& job) {
  std::atomic<std::size_t> done = 0;
  const std::size_t rootLevel = shallow.rootLevel();
  tbb::parallel_for(std::uint32_t(0), shallow.subtrees(), [&](std::uint32_t root) {
    Workspace& work = workspaces.local();
    // Clusters that are roots themselves hold photons that they do not accept.
    for (const SubtreeLists::Which which : {SubtreeLists::kTouching, SubtreeLists::kEnclosing})
      shallow.forEachPart(rootLevel, root, which, kPhotonsPerPart, work.part,
                          [&](std::span<const std::uint32_t> photons) {
                            job.throwIfStopped();
                            addPart(root, photons, simd, work);
                          });
    const std::size_t now = ++done;
    if (now % 64 == 0) job.report("photon_directional", double(now) / double(shallow.subtrees()));
  });
}

void PhotonDirectional::Scratch::addPart(std::uint32_t root, std::span<const std::uint32_t> photons,
                                         SimdLevel simd, Workspace& work) {
  std::array<std::uint32_t, kOctants + 1> begin{};
  for (const std::uint32_t photon : photons) ++begin[octants[photon] + 1];
  for (std::size_t o = 0; o < kOctants; ++o) begin[o + 1] += begin[o];
  work.byOctant.resize(photons.size());
  std::array<std::uint32_t, kOctants + 1> next = begin;
  for (const std::uint32_t photon : photons) work.byOctant[next[octants[photon]]++] = photon;
  const std::size_t rootLevel = shallow.rootLevel();
  const Node& node = tree.levels()[rootLevel].nodes[root];
  Pairs& count = pairs[root];
  work.walk.prepare(tree, photons.size(), radius * radius, simd, true);
  work.photons.reserve(photons.size(), true);
  for (std::uint32_t o = 0; o < std::uint32_t(kOctants); ++o) {
    work.photons.count = 0;
    for (std::uint32_t i = begin[o]; i < begin[o + 1]; ++i) {
      if (i + kAhead < photons.size()) __builtin_prefetch(&spheres[work.byOctant[i + kAhead]]);
      work.photons.push(spheres[work.byOctant[i]], i - begin[o]);
    }
    if (work.photons.count == 0) continue;
    const auto addChildren = [&](const Node& parent, const PhotonColumns& from) {
      for (std::uint32_t leaf = parent.firstChild; leaf < parent.firstChild + parent.childCount(); ++leaf)
        addLeaf(leaf, o, from, simd, count);
    };
    if (rootLevel == leafLevel) {
      addLeaf(root, o, work.photons, simd, count);
    } else if (rootLevel == leafLevel + 1) {
      addChildren(node, work.photons);
    } else {
      work.walk.descend(rootLevel - 1, node.firstChild, node.childCount(), work.photons,
                        [&](std::size_t level, std::uint32_t at, const Sifted& sifted) {
                          flux[level][at][o] += powerOf(sifted.acceptedList(), work.photons);
                          count.accepted += sifted.acceptedCount;
                          if (sifted.touching.count == 0) return false;
                          if (level > leafLevel + 1) return true;
                          addChildren(tree.levels()[level].nodes[at], sifted.touching);
                          return false;
                        });
    }
  }
}

void PhotonDirectional::Scratch::addLeaf(std::uint32_t leaf, std::uint32_t octant, const PhotonColumns& from,
                                         SimdLevel simd, Pairs& count) {
  LeafSum sum;
  leafSumFor(simd)(shapes[leaf], radius * radius, from, sum);
  flux[leafLevel][leaf][octant] += sum.flux;
  count.tested += from.count;
  count.contributing += sum.felt;
}

void PhotonDirectional::Scratch::makeLights(const ViewSamples& view, SimdLevel simd) {
  for (std::size_t l = tree.levels().size() - 1; l-- > leafLevel;)
    tbb::parallel_for(std::size_t(0), flux[l].size(), [&](std::size_t i) {
      const Flux& above = flux[l + 1][tree.levels()[l].nodes[i].parent];
      for (std::size_t o = 0; o < kOctants; ++o) flux[l][i][o] += above[o];
    });
  lights.resize(leaves().size());
  tbb::parallel_for(std::uint32_t(0), std::uint32_t(lights.size()), [&](std::uint32_t leaf) {
    LeafLight& light = lights[leaf];
    for (std::size_t o = 0; o < kOctants; ++o) {
      light.r[o] = flux[leafLevel][leaf][o].x;
      light.g[o] = flux[leafLevel][leaf][o].y;
      light.b[o] = flux[leafLevel][leaf][o].z;
    }
    if (!rule.published) findSeen(view, leaf, simd);
  });
}

void PhotonDirectional::Scratch::findSeen(const ViewSamples& view, std::uint32_t leaf, SimdLevel simd) {
  float seen[kOctants] = {};
  float samples = 1.0f;
  if (isNarrow(leaf)) {
    for (std::uint32_t o = 0; o < std::uint32_t(kOctants); ++o)
      seen[o] = octantIrradiance(o, leaves().cones[leaf].axis);
  } else {
    samples = float(leaves().nodes[leaf].samples);
    const SeeFn see = seeFor(simd);
    for (std::uint32_t c = firstCluster[leaf]; c < firstCluster[leaf + 1]; ++c)
      for (const Patch& patch : clusters.patchesOf(c)) see(view.tiles[patch.tile], patch.lanes, seen);
  }
  // Light that goes through is seen from behind, too.
  const bool transmits = leaves().transmits(leaf);
  for (std::size_t o = 0; o < kOctants; ++o) {
    const float all = seen[o] + (transmits ? seen[kOctants - 1 - o] : 0.0f);
    lights[leaf].inverseSeen[o] = all > kLeastSeen * samples ? samples / all : 0.0f;
  }
}

void PhotonDirectional::Scratch::shade(const In& in, Radiance& irradiance, Radiance& reflectance,
                                       const Job& job) const {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, in.view.tiles.size(), 64), [&](const auto& range) {
    job.throwIfStopped();
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      if (i + 1 < range.end()) {
        const ViewTile& next = in.view.tiles[i + 1];
        want(next.ngX, offsetof(ViewTile, woX) - offsetof(ViewTile, ngX));
        want(next.diffuseR, sizeof(next.diffuseR) * 3);
        want(&next.bounds, 1);
        want(&irradiance[i + 1], sizeof(RadianceTile));
        want(&reflectance[i + 1], sizeof(RadianceTile));
      }
      shadeTile(in.view.tiles[i], i, in.simd, irradiance[i], reflectance[i]);
    }
  });
}

void PhotonDirectional::Scratch::shadeTile(const ViewTile& tile, std::size_t index, SimdLevel simd,
                                           RadianceTile& irradiance, RadianceTile& reflectance) const {
  irradiance = {};
  if (tile.count == 0) {
    reflectance = {};
    return;
  }
  reflectFor(simd)(tile, reflectance);
  const ShadeFn shadePatch = shadeFor(rule, simd);
  for (std::uint32_t p = tileBegin[index]; p < tileBegin[index + 1]; ++p) {
    const PatchOfTile& patch = patches[p];
    const LeafLight& light = lights[patch.leaf];
    if (leaves().transmits(patch.leaf))
      shadeTransmitting(tile, patch.lanes, light, rule, irradiance, reflectance);
    else if (!rule.published && patch.flat && isNarrow(patch.leaf))
      shadeAlike(patch.lanes, light.sum(), irradiance);
    else
      shadePatch(tile, {patch.lanes, patch.flat, isNarrow(patch.leaf), leaves().cones[patch.leaf].axis},
                 light, rule, irradiance, reflectance);
  }
}

void PhotonDirectional::Scratch::tell(Stats& stats, std::uint32_t passes) const {
  Pairs sum;
  for (const Pairs& p : pairs) {
    sum.tested += p.tested;
    sum.contributing += p.contributing;
    sum.accepted += p.accepted;
  }
  std::vector<double> nodes;
  std::uint64_t fluxBytes = lights.size() * sizeof(LeafLight) + shapes.size() * sizeof(LeafShape);
  for (const Level& level : tree.levels()) nodes.push_back(double(level.size()));
  for (std::size_t l = leafLevel; l < tree.levels().size(); ++l) fluxBytes += flux[l].size() * sizeof(Flux);
  stats.setCounter("photon_directional.pairsTested", double(sum.tested));
  stats.setCounter("photon_directional.pairsContributing", double(sum.contributing));
  stats.setCounter("photon_directional.pairsAccepted", double(sum.accepted + shallowAccepted));
  stats.setCounter("photon_directional.nodes", std::move(nodes));
  stats.setCounter("photon_directional.subPasses", double(passes));
  stats.peakBytes("photon_directional.photons",
                  spheres.capacity() * sizeof(PhotonSphere) + octants.capacity());
  stats.peakBytes("photon_directional.tree", tree.bytes() + clusters.bytes());
  stats.peakBytes("photon_directional.patches",
                  patches.size() * sizeof(PatchOfTile) + tileBegin.size() * sizeof(std::uint32_t));
  stats.peakBytes("photon_directional.lists", shallow.bytes());
  stats.peakBytes("photon_directional.flux", fluxBytes);
}

PhotonDirectional::PhotonDirectional(PhotonDirectionalSettings settings)
    : settings_(settings), scratch_(std::make_unique<Scratch>()) {}
PhotonDirectional::~PhotonDirectional() = default;
PhotonDirectional::PhotonDirectional(PhotonDirectional&&) noexcept = default;
PhotonDirectional& PhotonDirectional::operator=(PhotonDirectional&&) noexcept = default;

void PhotonDirectional::run(const In& in, Radiance& irradiance, Radiance& reflectance, Stats& stats,
                            const Job& job) {
  Scratch& s = *scratch_;
  {
    const Stats::Scope scope = stats.scope("photon_directional.build");
    s.build(in, settings_);
    irradiance.resize(in.view.tiles.size());
    reflectance.resize(in.view.tiles.size());
  }
  std::uint32_t passes = 0;
  if (s.shallow.subtrees() > 0) {
    passes = forEachSubPass(
        in.map.photons, in.radius, "photon_directional.radius", s.spheres, job,
        [&](std::uint32_t first, std::uint64_t maxBytes) {
          const Stats::Scope scope = stats.scope("photon_directional.shallow");
          const std::uint32_t taken = s.fillLists(first, maxBytes, in.simd, job);
          s.addShallow();
          return taken;
        },
        [&](const Job& part) {
          const Stats::Scope scope = stats.scope("photon_directional");
          s.addSubtrees(in.simd, part);
        });
  }
  const Stats::Scope scope = stats.scope("photon_directional.shade");
  if (s.shallow.subtrees() > 0) s.makeLights(in.view, in.simd);
  s.shade(in, irradiance, reflectance, job);
  s.tell(stats, passes);
}

}  // namespace isophote
