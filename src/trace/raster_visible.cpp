// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "trace/raster_setup.h"

#include <array>
#include <limits>

namespace isophote::raster {

Projector projectorOf(const RasterView& view) {
  if (view.width < 1 || view.height < 1 || view.width > 32768 || view.height > 32768)
    failUsage("", "a view of {} x {} pixels cannot be rasterised; its sides may be 1 to 32768", view.width,
              view.height);
  using dvec3 = glm::dvec3;
  const dvec3 right(view.camera.right), up(view.camera.up), forward(view.camera.forward);
  const double volume = glm::dot(right, glm::cross(up, forward));
  if (!(std::abs(volume) > 0.0)) failUsage("", "the axes of a view lie in one plane");
  const double halfWidth = 0.5 * view.width, halfHeight = 0.5 * view.height;
  Projector p{};
  p.eye = view.camera.eye;
  p.toX = vec3(glm::cross(up, forward) * (halfWidth / volume));
  p.toY = vec3(glm::cross(forward, right) * (-halfHeight / volume));
  p.toZ = vec3(glm::cross(right, up) / volume);
  p.offsetX = float(halfWidth - double(view.subpixel.x));
  p.offsetY = float(halfHeight - double(view.subpixel.y));
  p.orthographic = view.camera.orthographic > 0.5f ? 1.0f : 0.0f;
  p.nearest = view.nearest;
  p.width = view.width;
  p.height = view.height;
  p.edgeOfKeys = p.orthographic > 0.5f ? -view.nearest
                 : view.nearest > 0.0f ? 1.0f / view.nearest
                                       : std::numeric_limits<float>::infinity();
  return p;
}

namespace {

/// What is visible has normal * position + distance >= 0.
struct Plane {
  float normal[3];
  float distance;
};
constexpr int kPlanes = 5;
using Planes = std::array<Plane, kPlanes>;  ///< The last: depth beyond the nearest one.

/// In the space of an instance.
Planes planesOf(const Projector& p, const mat4x3& world) {
  using dvec3 = glm::dvec3;
  struct Linear {
    dvec3 normal;
    double distance;
  };
  const dvec3 eye(p.eye);
  const bool parallel = p.orthographic > 0.5f;
  const Linear z{dvec3(p.toZ), -glm::dot(dvec3(p.toZ), eye)};
  const Linear w = parallel ? Linear{dvec3(0.0), 1.0} : z;
  const auto sum = [](const Linear& a, double scale, const Linear& b) {
    return Linear{a.normal * scale + b.normal, a.distance * scale + b.distance};
  };
  const Linear x = sum(w, double(p.offsetX), {dvec3(p.toX), -glm::dot(dvec3(p.toX), eye)});
  const Linear y = sum(w, double(p.offsetY), {dvec3(p.toY), -glm::dot(dvec3(p.toY), eye)});
  const Linear inWorld[kPlanes] = {x,
                                   sum(x, -1.0, sum(w, double(p.width - 1), {dvec3(0.0), 0.0})),
                                   y,
                                   sum(y, -1.0, sum(w, double(p.height - 1), {dvec3(0.0), 0.0})),
                                   {z.normal, z.distance - double(p.nearest)}};
  Planes planes;
  for (int i = 0; i < kPlanes; ++i) {
    const Linear& l = inWorld[i];
    for (int axis = 0; axis < 3; ++axis)
      planes[std::size_t(i)].normal[axis] = float(glm::dot(l.normal, dvec3(world[axis])));
    planes[std::size_t(i)].distance = float(glm::dot(l.normal, dvec3(world[3])) + l.distance);
  }
  return planes;
}

/// More than the rounding of every step from an object's vertex to the picture.
constexpr float kSlack = 1e-5f;

/// For 16 boxes: whether they may be in view, and their depth.
SHARED_FN void testBoxesBody(const Planes& planes, const float* const* centre, const float* const* half,
                             int* visible, float* depth) {
  for (std::uint32_t i = 0; i < kRasterLanes; ++i) visible[i] = 1;
  for (const Plane& plane : planes) {
    const float nx = plane.normal[0], ny = plane.normal[1], nz = plane.normal[2], d = plane.distance;
    const float ax = abs(nx), ay = abs(ny), az = abs(nz), ad = abs(d);
    for (std::uint32_t i = 0; i < kRasterLanes; ++i) {
      const float x = centre[0][i], y = centre[1][i], z = centre[2][i];
      const float value = nx * x + ny * y + nz * z + d;
      const float extent = ax * half[0][i] + ay * half[1][i] + az * half[2][i];
      const float magnitude = ax * abs(x) + ay * abs(y) + az * abs(z) + extent + ad;
      visible[i] &= value + extent >= -kSlack * magnitude ? 1 : 0;
      depth[i] = value;
    }
  }
}
ISOPHOTE_SIMD(testBoxes, testBoxesBody,
              (const Planes& planes, const float* const* centre, const float* const* half, int* visible,
               float* depth),
              (planes, centre, half, visible, depth))

constexpr std::uint32_t kBuckets = 2048;

/// Eight buckets for each doubling of the depth.
std::uint16_t bucketOf(float depth) {
  return std::uint16_t(floatBitsToUint(depth > 0.0f ? depth : 0.0f) >> 20);
}

}  // namespace

void findVisible(const RasterScene& scene, const Projector& projector, SimdLevel level,
                 VisibleBlocks& blocks) {
  blocks.found.clear();
  blocks.bucket.clear();
  const auto test = testBoxesFor(level);
  alignas(64) float centres[3][kRasterLanes] = {}, halves[3][kRasterLanes] = {}, depth[kRasterLanes];
  alignas(64) int visible[kRasterLanes];
  const float* const centre[3] = {centres[0], centres[1], centres[2]};
  const float* const half[3] = {halves[0], halves[1], halves[2]};
  for (std::uint32_t i = 0; i < scene.instances().size(); ++i) {
    const RasterMesh& mesh = scene.meshes()[scene.instances()[i].mesh];
    const ShadedInstance& shaded = scene.trace().instance(i);
    const Planes planes = planesOf(projector, shaded.inWorldSpace ? mat4x3(1.0f) : shaded.worldFromObject);
    for (std::uint32_t first = 0; first < mesh.blocks; first += kRasterLanes) {
      const std::uint32_t count = std::min(kRasterLanes, mesh.blocks - first);
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t from = mesh.firstBlock + first;
        std::copy_n(scene.boxes().centre[axis].data() + from, count, centres[axis]);
        std::copy_n(scene.boxes().half[axis].data() + from, count, halves[axis]);
      }
      test(planes, centre, half, visible, depth);
      for (std::uint32_t lane = 0; lane < count; ++lane)
        if (visible[lane]) {
          blocks.found.push_back({mesh.firstBlock + first + lane, i});
          blocks.bucket.push_back(bucketOf(depth[lane]));
        }
    }
  }

  std::array<std::uint32_t, kBuckets + 1> begins{};
  for (std::uint16_t bucket : blocks.bucket) ++begins[std::size_t(bucket) + 1];
  for (std::size_t i = 1; i <= kBuckets; ++i) begins[i] += begins[i - 1];
  blocks.sorted.resize(blocks.found.size());
  for (std::size_t i = 0; i < blocks.found.size(); ++i)
    blocks.sorted[begins[blocks.bucket[i]]++] = blocks.found[i];
}

}  // namespace isophote::raster
