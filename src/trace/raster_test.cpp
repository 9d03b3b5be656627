// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "trace/raster.h"

#include "base/error.h"
#include "math/rng.shared.h"
#include "scene/builtin/builtin.h"
#include "trace/raster_exact.h"
#include "trace/raster_test_support.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <cmath>

namespace isophote {
namespace {

Scene builtinScene(const char* name) {
  Scene scene = findBuiltinScene(name)->make();
  finishScene(scene, name);
  return scene;
}

/// How far ray `pixel` passes from the nearest of the planes through the eye and an edge, in pixels.
double pixelsFromEdge(const BothWays& both, const RasterScene& scene, std::size_t pixel, const Hit& hit) {
  using dvec3 = glm::dvec3;
  const ShadedTriangle t = worldTriangle(scene.trace().instance(hit.instance), hit.triangle);
  const CameraRays& camera = both.view.camera;
  const Ray ray = both.ray(pixel);
  const dvec3 met = dvec3(ray.origin) + dvec3(ray.direction) * double(hit.t);
  double least = 1e30;
  for (int k = 0; k < 3; ++k) {
    const dvec3 a(t.position[k]), b(t.position[(k + 1) % 3]);
    const dvec3 normal = camera.orthographic > 0.5f
                             ? glm::cross(dvec3(camera.forward), b - a)
                             : glm::cross(a - dvec3(camera.eye), b - dvec3(camera.eye));
    const double distance = std::abs(glm::dot(met - a, glm::normalize(normal)));
    const double depth =
        camera.orthographic > 0.5f ? 1.0 : glm::dot(met - dvec3(camera.eye), dvec3(camera.forward));
    const double pixelSize = 2.0 * double(length(camera.right)) / both.view.width * depth;
    least = std::min(least, distance / pixelSize);
  }
  return least;
}

/// A hundredth of a pixel: a few roundings of floats (2^-24 each) of numbers up to some thousands of pixels,
/// the extent of triangles near the eye, in the projection here and in the traced ray.
constexpr double kEdgeTolerance = 0.01;

/// Every pixel sees the same surface both ways, but for rays that rounding takes past an edge, `most` of all
/// pixels.
void expectAgrees(const RasterScene& scene, const RasterView& view, double most = 0.002) {
  const BothWays both(scene, view);
  int atEdges = 0;
  int wrong = 0;
  for (std::size_t i = 0; i < both.triangles.size(); ++i) {
    const Hit &r = both.rastered[i], &t = both.traced[i];
    EXPECT_EQ(r.valid(), both.triangles[i] != kNoTriangle);
    if (!r.valid() && !t.valid()) continue;
    // The same surface, or another in the same place.
    if (r.valid() && t.valid() && std::abs(r.t - t.t) <= 2e-4f * t.t) continue;
    const Hit& nearer = r.valid() && (!t.valid() || r.t < t.t) ? r : t;
    ++atEdges;
    wrong += pixelsFromEdge(both, scene, i, nearer) > kEdgeTolerance;
  }
  EXPECT_EQ(wrong, 0);
  EXPECT_LE(atEdges, most * double(both.triangles.size()) + 2.0);
}

RasterView viewOf(const Camera& camera, int width, int height) {
  return {cameraRays(camera, width, height), width, height};
}

TEST(Raster, AgreesWithTracedRaysInEveryBuiltinScene) {
  for (const BuiltinScene& entry : builtinScenes()) {
    SCOPED_TRACE(entry.name);
    Scene scene = entry.make();
    finishScene(scene, std::string(entry.name));
    const TraceScene trace(scene);
    const RasterScene raster(trace);
    for (const Camera& camera : scene.cameras) {
      SCOPED_TRACE(camera.name);
      expectAgrees(raster, viewOf(camera, 321, 181));
    }
  }
}

TEST(Raster, AgreesWithEyesAmongTheTriangles) {
  const Scene scene = builtinScene("atrium");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  for (std::uint32_t i = 0; i < 12; ++i) {
    SCOPED_TRACE(i);
    Camera camera;
    const Bounds& bounds = scene.bounds;
    camera.eye = bounds.lower + random3(7, i, 0) * bounds.size();
    camera.target = camera.eye + sampleSphereDirection(i);
    camera.verticalFovDegrees = 100;
    RasterView view = viewOf(camera, 160, 120);
    view.subpixel = vec2(0.25f, 0.75f);
    expectAgrees(raster, view);
  }
}

TEST(Raster, AgreesForParallelRays) {
  const Scene scene = builtinScene("atrium");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  Camera camera;
  camera.target = scene.bounds.centre();
  camera.orthographicHeight = 20;
  for (const vec3 from : {vec3(3, 30, 4), vec3(0.1f, 2, 0.3f)}) {
    camera.eye = camera.target + from;
    expectAgrees(raster, viewOf(camera, 200, 150));
  }
}

/// A room of one quad a side, seen from a point close to one of them: every triangle passes the plane of the
/// eye on some face of the cube.
Scene room(std::uint32_t divisions) {
  Scene scene;
  scene.materials.push_back({makeMaterial(), "grey"});
  for (int side = 0; side < 6; ++side) {
    const CameraRays face = cubeFaceRays(vec3(0), side);
    Mesh mesh;
    for (std::uint32_t y = 0; y <= divisions; ++y)
      for (std::uint32_t x = 0; x <= divisions; ++x) {
        const vec2 p = vec2(float(x), float(y)) * (2.0f / float(divisions)) - vec2(1.0f);
        mesh.positions.push_back(face.forward + face.right * p.x + face.up * p.y);
      }
    for (std::uint32_t y = 0; y < divisions; ++y)
      for (std::uint32_t x = 0; x < divisions; ++x) {
        const std::uint32_t a = y * (divisions + 1) + x, b = a + 1, c = a + divisions + 1, d = c + 1;
        mesh.triangles.push_back({a, d, b});
        mesh.triangles.push_back({a, c, d});
      }
    scene.meshes.push_back(mesh);
    scene.instances.push_back({"side", std::uint32_t(side), mat4x3(1.0f)});
  }
  finishScene(scene, "room");
  return scene;
}

void expectEveryPixelSeesASurface(const RasterScene& scene, vec3 eye, int size) {
  LargeVector<std::uint32_t> triangles;
  Rasteriser rasteriser;
  for (int face = 0; face < 6; ++face) {
    rasteriser.run(scene, {cubeFaceRays(eye, face), size, size}, {&triangles, nullptr});
    EXPECT_EQ(std::count(triangles.begin(), triangles.end(), kNoTriangle), 0) << "face " << face;
  }
}

TEST(Raster, LeavesNoGapsInsideAClosedRoom) {
  for (const std::uint32_t divisions : {1u, 2u, 7u, 64u, 101u}) {
    const Scene scene = room(divisions);
    const TraceScene trace(scene);
    const RasterScene raster(trace);
    SCOPED_TRACE(divisions);
    // In the middle, with 101 pixels or divisions of them, vertices and edges lie exactly at pixels' centres.
    expectEveryPixelSeesASurface(raster, vec3(0.0f), 101);
    expectEveryPixelSeesASurface(raster, vec3(0.0f), 202);
    expectEveryPixelSeesASurface(raster, vec3(0.3f, -0.2f, 0.7f), 257);
    expectEveryPixelSeesASurface(raster, vec3(0.9999f, 0.99999f, 0.5f), 128);
  }
}

TEST(Raster, AgreesWithTracedRaysThroughTrianglesAroundTheEye) {
  const Scene scene = room(3);
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  for (const vec3 eye : {vec3(0.0f), vec3(0.3f, -0.2f, 0.7f), vec3(0.99f, 0.2f, 0.3f)})
    // Edges run along rows of pixels' centres, where traced rays now and then pass between two triangles.
    for (int face = 0; face < 6; ++face) expectAgrees(raster, {cubeFaceRays(eye, face), 100, 100}, 0.01);
}

/// The faces' rays, weighted by the solid angles of their pixels, cover the sphere once.
TEST(Raster, CubeFacesSeeEveryDirectionOnce) {
  const float c = std::cos(0.4f), s = std::sin(0.4f);
  const mat3 turned(vec3(c, s, 0), vec3(-s, c, 0), vec3(0, 0, 1));
  for (std::uint32_t i = 0; i < 1000; ++i) {
    const vec3 direction = sampleSphereDirection(i);
    for (const mat3& axes : {mat3(1.0f), turned}) {
      int faces = 0;
      for (int face = 0; face < 6; ++face) {
        const CameraRays rays = cubeFaceRays(vec3(0), face, axes);
        const float depth = dot(direction, rays.forward);
        faces += depth > 0 && std::abs(dot(direction, rays.right)) < depth &&
                 std::abs(dot(direction, rays.up)) < depth;
      }
      EXPECT_EQ(faces, 1);
    }
  }
}

/// Vertices at pixels' centres and off them: each pixel inside the grid belongs to exactly one triangle.
TEST(Raster, EveryPixelOfAMeshBelongsToOneTriangle) {
  constexpr int kSide = 6, kPixels = 40;
  std::vector<raster::RasterVertex> vertices;
  for (std::uint32_t y = 0; y <= kSide; ++y)
    for (std::uint32_t x = 0; x <= kSide; ++x) {
      const vec3 u = random3(11, y * 100 + x, 0);
      const bool inner = x > 0 && y > 0 && x < kSide && y < kSide;
      const float w = 0.5f + u.z;
      const float px = float(kPixels * x) / kSide + (inner ? std::floor(u.x * 5.0f) : 0.0f) - 1.0f;
      const float py = float(kPixels * y) / kSide + (inner ? std::floor(u.y * 5.0f) * 0.5f : 0.0f) - 1.0f;
      vertices.push_back({px * w, py * w, w, w});
    }
  int onEdges = 0;
  for (int y = 0; y < kPixels - 2; ++y)
    for (int x = 0; x < kPixels - 2; ++x) {
      int covering = 0;
      for (int cell = 0; cell < kSide * kSide; ++cell) {
        const int a = cell / kSide * (kSide + 1) + cell % kSide;
        const raster::RasterVertex corners[4] = {vertices[std::size_t(a)], vertices[std::size_t(a + 1)],
                                                 vertices[std::size_t(a + kSide + 1)],
                                                 vertices[std::size_t(a + kSide + 2)]};
        const raster::RasterVertex lower[3] = {corners[0], corners[1], corners[3]};
        const raster::RasterVertex upper[3] = {corners[0], corners[3], corners[2]};
        // As seen from the front, or turned over.
        const raster::RasterVertex upperTurned[3] = {corners[3], corners[0], corners[2]};
        covering += raster::covers(lower, false, x, y);
        covering +=
            (x + y) % 2 ? raster::covers(upper, false, x, y) : raster::covers(upperTurned, true, x, y);
      }
      EXPECT_EQ(covering, 1) << x << ", " << y;
      onEdges += covering != 1;
    }
  EXPECT_EQ(onEdges, 0);
}

TEST(Raster, GivesTheSameBytesForAnyThreadsAndInstructionSet) {
  const Scene scene = builtinScene("atrium");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  const RasterView view = viewOf(scene.cameras.front(), 333, 222);
  const BothWays expected(raster, view);
  for (const int threads : {1, 2, 5})
    for (const SimdLevel level : {SimdLevel::kBaseline, SimdLevel::kAvx2, SimdLevel::kAvx512}) {
      if (level > bestSimdLevel()) continue;
      LargeVector<std::uint32_t> triangles;
      LargeVector<float> depths, depthsAlone;
      tbb::task_arena(threads).execute([&] {
        Rasteriser rasteriser(level);
        rasteriser.run(raster, view, {&triangles, &depths});
        rasteriser.run(raster, view, {nullptr, &depthsAlone});
      });
      EXPECT_TRUE(triangles == expected.triangles);
      EXPECT_TRUE(depths == expected.depths);
      EXPECT_TRUE(depthsAlone == expected.depths);
    }
}

TEST(Raster, DepthsAreAlongTheForwardAxis) {
  const Scene scene = builtinScene("atrium");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  Camera parallel = scene.cameras.front();
  parallel.orthographicHeight = 8;
  for (const Camera& camera : {scene.cameras.front(), parallel}) {
    const BothWays both(raster, viewOf(camera, 200, 100));
    for (std::size_t i = 0; i < both.triangles.size(); ++i) {
      if (!both.rastered[i].valid()) {
        EXPECT_EQ(both.depths[i], kNoDepth);
        continue;
      }
      const float depth = both.rastered[i].t * dot(both.ray(i).direction, both.view.camera.forward);
      // Rounding of world coordinates weighs most close to the eye.
      EXPECT_NEAR(both.depths[i], depth, 1e-4f * depth + 2e-5f);
    }
  }
}

/// A square of two triangles at that z, facing +z.
Mesh square(float side, float z, std::uint32_t material) {
  Mesh mesh;
  mesh.positions = {{-side, -side, z}, {side, -side, z}, {side, side, z}, {-side, side, z}};
  mesh.uvs = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = material;
  return mesh;
}

Camera lookingAtOriginFrom(vec3 eye) {
  Camera camera;
  camera.eye = eye;
  camera.target = vec3(0);
  return camera;
}

/// One instance for each of those meshes.
Scene greyScene(std::vector<Mesh> meshes, std::initializer_list<std::uint32_t> placed) {
  Scene scene;
  scene.materials.push_back({makeMaterial(), "grey"});
  scene.meshes = std::move(meshes);
  for (const std::uint32_t mesh : placed) scene.instances.push_back({"", mesh, mat4x3(1.0f)});
  finishScene(scene, "grey");
  return scene;
}

/// Leaves before a wall, with holes by their texture's alpha; or, without texture, by that of their vertices.
void expectMasksAsRaysDo(bool textured) {
  Scene scene;
  Texture texture;
  texture.width = texture.height = 16;
  for (std::uint32_t i = 0; i < 256; ++i)
    for (int channel = 0; channel < 4; ++channel)
      texture.rgba.push_back(channel == 3 ? std::uint8_t(255.0f * random3(5, i, 0).x) : std::uint8_t(255));
  scene.textures.push_back(texture);
  scene.materials.push_back({makeMaterial(), "grey"});
  NamedMaterial masked{makeMaterial(), "leaves"};
  masked.flags |= kMaterialAlphaMask;
  masked.alphaCutoff = 0.5f;
  masked.baseColourTexture = textured ? 0 : -1;
  scene.materials.push_back(masked);
  scene.meshes = {square(1.0f, 0.0f, 1), square(2.0f, -1.0f, 0)};
  if (!textured)
    for (const vec3 p : scene.meshes[0].positions) scene.meshes[0].colours.emplace_back(1, 1, 1, p.x > 0.0f);
  scene.instances = {{"leaves", 0, mat4x3(1.0f)}, {"wall", 1, mat4x3(1.0f)}};
  finishScene(scene, "masked");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  const BothWays both(raster, viewOf(lookingAtOriginFrom(vec3(0.4f, 0.3f, 2.0f)), 160, 160));
  int leaves = 0, wall = 0, differing = 0;
  for (std::size_t i = 0; i < both.triangles.size(); ++i) {
    leaves += both.rastered[i].instance == 0;
    wall += both.rastered[i].instance == 1;
    differing += both.rastered[i].instance != both.traced[i].instance;
  }
  EXPECT_GT(leaves, 1000);
  EXPECT_GT(wall, 1000);
  // Where alpha is the cutoff to within rounding.
  EXPECT_LE(differing, 3);
}

TEST(Raster, SeesThroughAlphaMasksAsRaysDo) {
  expectMasksAsRaysDo(true);
  expectMasksAsRaysDo(false);
}

TEST(Raster, OfCoincidingTrianglesSeesTheFirst) {
  const Scene scene = greyScene({square(1.0f, 0.0f, 0)}, {0, 0, 0});
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  const BothWays both(raster, viewOf(lookingAtOriginFrom(vec3(0.3f, 0.2f, 3.0f)), 90, 90));
  int seen = 0;
  for (const Hit& hit : both.rastered) {
    if (!hit.valid()) continue;
    ++seen;
    EXPECT_EQ(hit.instance, 0u);
  }
  EXPECT_GT(seen, 500);
}

TEST(Raster, LeavesOutWhatIsNearerThanAsked) {
  const Scene scene = greyScene({square(1.0f, 0.0f, 0), square(4.0f, -1.0f, 0)}, {0, 1});
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  Camera camera = lookingAtOriginFrom(vec3(0, 0, 2));
  for (const float orthographicHeight : {0.0f, 2.0f}) {
    camera.orthographicHeight = orthographicHeight;
    RasterView view = viewOf(camera, 64, 64);
    const BothWays all(raster, view);
    EXPECT_EQ(all.rastered[32 * 64 + 32].instance, 0u);
    view.nearest = 2.0f;
    const BothWays beyond(raster, view);
    for (const Hit& hit : beyond.rastered) EXPECT_EQ(hit.instance, 1u);
    view.nearest = 3.5f;
    const BothWays none(raster, view);
    for (const Hit& hit : none.rastered) EXPECT_FALSE(hit.valid());
  }
}

TEST(Raster, RefusesViewsThatCannotBe) {
  const Scene scene = builtinScene("cornell-box");
  const TraceScene trace(scene);
  const RasterScene raster(trace);
  RasterView view = viewOf(scene.cameras.front(), 8, 8);
  LargeVector<float> depths;
  view.width = 0;
  EXPECT_THROW(Rasteriser().run(raster, view, {nullptr, &depths}), Error);
  view.width = 8;
  view.camera.up = vec3(0);
  EXPECT_THROW(Rasteriser().run(raster, view, {nullptr, &depths}), Error);
}

TEST(Raster, StaysWithinItsMemoryBudget) {
  const Scene scene = builtinScene("cornell-box");
  const TraceScene trace(scene);
  EXPECT_THROW(RasterScene(trace, Job{.memoryBudgetBytes = 256}), Error);
  EXPECT_NO_THROW(RasterScene(trace, Job{.memoryBudgetBytes = 1 << 20}));
}

}  // namespace
}  // namespace isophote
