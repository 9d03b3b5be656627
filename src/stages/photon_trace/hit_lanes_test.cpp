// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Hits shaded side by side against the same hits shaded one by one (trace/surface.h).
#include "stages/photon_trace/hit_lanes.h"
#include "physics/shading_normal.shared.h"

#include "stages/photon_trace/test_photons.h"
#include "support/statistics.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

/// Random texels.
Texture noise(std::uint32_t stream, bool srgb, int least = 0) {
  Texture texture;
  texture.name = "noise";
  texture.width = texture.height = 16;
  texture.srgb = srgb;
  for (std::uint32_t i = 0; i < 256; ++i) {
    const vec3 u = randomTriple(stream, i);
    for (const float x : {u.x, u.y, u.z, randomTriple(stream + 1, i).x})
      texture.rgba.push_back(std::uint8_t(float(least) + x * (255.99f - float(least))));
  }
  return texture;
}

/// A curved patch of every kind of material, placed once as it is and once turned and scaled.
Scene everySurface() {
  Scene scene;
  scene.textures = {noise(1, true), noise(3, false), noise(5, false, 128)};
  std::vector<NamedMaterial> materials;
  const auto add = [&](const char* name, auto&& edit) {
    NamedMaterial m{makeMaterial(), name};
    m.baseColour = vec3(0.8f, 0.6f, 0.4f);
    m.roughness = 0.4f;
    edit(m);
    materials.push_back(m);
  };
  add("lambert", [](Material& m) { m.specular = 0.0f; });
  add("mapped lambert", [](Material& m) { m.specular = 0.0f, m.normalTexture = 2, m.normalScale = 0.5f; });
  add("glossy",
      [](Material& m) { m.baseColourTexture = 0, m.metallicRoughnessTexture = 1, m.metallic = 1.0f; });
  add("mapped glossy", [](Material& m) {
    m.baseColourTexture = 0, m.metallicRoughnessTexture = 1, m.normalTexture = 2, m.normalScale = -1.5f;
  });
  add("coloured reflection", [](Material& m) {
    m.specularColour = vec3(1.0f, 0.3f, 0.1f), m.specularColourTexture = 0, m.specularTexture = 1;
  });
  add("rough glass",
      [](Material& m) { m.transmission = 0.8f, m.transmissionTexture = 1, m.normalTexture = 2; });
  add("unlit", [](Material& m) { m.flags = kMaterialUnlit, m.baseColourTexture = 0; });
  for (std::size_t i = 0; i < materials.size(); ++i) {
    const std::uint32_t material = addMaterial(scene, materials[i]);
    Mesh patch;
    addPatch(patch, {.columns = 12, .rows = 12}, [&](int column, int row) {
      const float x = float(column) / 12.0f, z = float(row) / 12.0f;
      return vec3(x + 1.2f * float(i), 0.15f * std::sin(5.0f * x + 3.0f * z), -z);
    });
    scaleUvs(patch, 0.37f);
    if (i % 2 == 0)
      for (std::uint32_t v = 0; v < patch.positions.size(); ++v)
        patch.colours.emplace_back(randomTriple(7, v), 1.0f);
    if (i == 2) patch.normals.clear();
    const std::uint32_t mesh = addMesh(scene, materials[i].name, material, patch);
    addInstance(scene, "here", mesh, mat4x3(1.0f));
    addInstance(scene, "there", mesh, mat4x3({0, 0, 2}, {0, 0.7f, 0}, {-1.5f, 0, 0}, {3, -2, 4}));
  }
  scene.lights.push_back(pointLight({0, 5, 0}, vec3(1.0f)));
  finishScene(scene, "every surface");
  return scene;
}

struct Arrival {
  Ray ray;
  Hit hit;
};

/// Rays at the middle of triangles, from both sides.
std::vector<Arrival> arrivals(const TraceScene& trace, std::uint32_t count) {
  std::vector<Arrival> list;
  const vec3 lower = trace.scene().bounds.lower, size = trace.scene().bounds.size();
  for (std::uint32_t i = 0; list.size() < count; ++i) {
    const vec3 from = lower + (randomTriple(11, i) * 3.0f - 1.0f) * size;
    const vec3 to = lower + randomTriple(12, i) * size;
    const Ray ray{from, 0.0f, normalize(to - from), 1e30f};
    const Hit hit = trace.closestHit(ray);
    if (hit.valid()) list.push_back({ray, hit});
  }
  return list;
}

void expectNear(vec3 a, vec3 b, float tolerance, const std::string& what) {
  EXPECT_LE(length(a - b), tolerance * std::max(1.0f, length(b)))
      << what << ": " << a.x << ' ' << a.y << ' ' << a.z << " instead of " << b.x << ' ' << b.y << ' ' << b.z;
}

/// What one photon does, worked out by the shared functions alone.
struct Expected {
  Surface surface;
  BsdfSample sample;
  vec3 power;
  bool survives;
};

Expected expectedOf(const TraceScene& trace, const Arrival& at, vec3 power, vec3 u) {
  Expected e;
  e.surface = surfaceAt(trace, at.ray, at.hit);
  const Surface& s = e.surface;
  e.sample = sampleBsdf(s.bsdf, -at.ray.direction, s.ng, s.ns, s.entering, u);
  const vec3 weight = e.sample.weight * photonShadingFactor(-at.ray.direction, e.sample.wi, s.ng, s.ns);
  const float survival = photonSurvival(power, weight);
  e.survives = e.sample.rest < survival;
  e.power = power * weight / std::max(survival, 1e-37f);
  return e;
}

TEST(HitLanes, ShadeAsSurfaceAtDoes) {
  const Scene scene = everySurface();
  const TraceScene trace(scene);
  const std::vector<Arrival> all = arrivals(trace, 32 * kHitLanes);
  constexpr std::uint32_t kEvent = 7;  // beyond those of the Sobol sequence
  const SobolTable sobol;
  PathRandom random(sobol);
  random.start(3, 0, scene.lights.size());
  PathColumns paths;
  PrefetchQueue queue;
  HitLanes lanes;
  int compared = 0;
  for (std::size_t first = 0; first < all.size(); first += kHitLanes) {
    lanes.clear();
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const Arrival& at = all[first + i];
      paths.set(i,
                {at.ray.origin, 1.0f, at.ray.direction, std::uint32_t(first) + i, vec3(0.9f, 0.6f, 0.3f), 0});
      lanes.add(trace, at.hit, i, queue);
    }
    lanes.place(trace, paths, queue);
    lanes.arrive(trace, queue);
    const HitColumn<std::uint32_t> stores = lanes.stores;
    const HitVectors position = lanes.points.position;
    lanes.scatter(random, kEvent);
    for (std::uint32_t i = 0; i < kHitLanes; ++i) {
      const Arrival& at = all[first + i];
      const std::string what = scene.meshes[scene.instances[at.hit.instance].mesh].name;
      const vec3 u = random3(pathKey(3, 0, 0, std::uint32_t(first) + i), kEvent, 0u);
      const Expected e = expectedOf(trace, at, vec3(0.9f, 0.6f, 0.3f), u);
      expectNear(position[i], e.surface.position, 1e-5f, what);
      EXPECT_EQ(stores[i] != 0u, hasNonDeltaLobe(e.surface.bsdf) > 0.5f) << what;
      // Choices that hang on the last digit may differ.
      if (e.sample.lobe == kLobeNone || (lanes.survives[i] != 0u) != e.survives) continue;
      if (length(lanes.direction[i] - e.sample.wi) > 0.01f) continue;
      ++compared;
      expectNear(lanes.direction[i], e.sample.wi, 2e-3f, what);
      expectNear(lanes.power[i], e.power, 5e-3f, what);
    }
  }
  // A seventh is unlit, and rough surfaces absorb some.
  EXPECT_GT(compared, int(all.size()) * 3 / 4);
}

}  // namespace
}  // namespace isophote
