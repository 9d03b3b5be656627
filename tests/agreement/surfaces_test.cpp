// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// Every kind of surface, one at a time, in a room whose indirect light the path tracer knows.
#include "agreement/agreement.h"
#include "scene/builtin/patterns.h"
#include "scene/builtin/shapes.h"

#include <functional>

namespace isophote {
namespace {

using Shape = std::function<void(Mesh&)>;

void addThing(Scene& scene, const char* name, NamedMaterial material, const Shape& shape) {
  material.name = name;
  Mesh mesh;
  shape(mesh);
  const std::uint32_t index = addMaterial(scene, material);
  addObject(scene, name, index, std::move(mesh));
}

/// A closed room of 2 m under a lamp; `walls` of it all.
Scene roomOf(const NamedMaterial& walls, const Shape& change = {}) {
  Scene scene;
  Texture bumps = chequer("bumps", 32, 8, vec3(0.7f, 0.4f, 0.8f), vec3(0.35f, 0.6f, 0.85f));
  bumps.srgb = false;
  scene.textures.push_back(bumps);
  addThing(scene, "room", walls, [&](Mesh& m) {
    addRoom(m, vec3(-1, 0, -1), vec3(1, 2, 1));
    if (change) change(m);
  });
  Light lamp{};
  lamp.type = kLightRectangle;
  lamp.position = vec3(-0.3f, 1.9f, -0.3f);
  lamp.edgeU = vec3(0.6f, 0, 0);
  lamp.edgeV = vec3(0, 0, 0.6f);
  lamp.colour = vec3(10.0f);
  scene.lights.push_back(lamp);
  Camera camera;
  camera.eye = vec3(0.1f, 1.1f, 0.97f);
  camera.target = vec3(0, 0.85f, 0);
  camera.verticalFovDegrees = 80;
  scene.cameras.push_back(camera);
  return scene;
}

NamedMaterial glass(float roughness) {
  NamedMaterial m = lambert("", vec3(0.9f, 0.8f, 0.7f));
  m.specular = 1.0f;
  m.transmission = 1.0f;
  m.roughness = roughness;
  return m;
}

void expectSurfacesAgree(Scene scene, const char* name, std::uint32_t seeds = 3, bool noisy = false) {
  if (kUnderSanitizers) GTEST_SKIP() << "measures noise and bias, for which the sanitizers are too slow";
  finishScene(scene, name);
  const TraceScene trace(scene);
  const Case c{name, 96, 96, 512, 1'000'000, seeds, 0.03f};
  RenderSettings settings;
  settings.frame.width = c.width;
  settings.frame.height = c.height;
  settings.photonTrace.photons = c.photons;
  settings.photonVolumes.radiusMin = settings.photonVolumes.radiusMax = 1.0f;
  settings.photonVolumes.flatness = 0.4f;
  settings.direct.areaSamples = 1;
  expectMeanAgrees(c, "volumes", extrapolatedIndirect(trace, settings, c),
                   meanOfReference(reference(trace, c)), noisy);
}

TEST(SurfaceAgreement, NormalMaps) {
  NamedMaterial walls = lambert("", vec3(0.7f));
  walls.normalTexture = 0;
  walls.normalScale = 0.7f;
  expectSurfacesAgree(roomOf(walls), "normal maps", 6, true);
}

TEST(SurfaceAgreement, VertexColours) {
  const Shape colour = [](Mesh& m) {
    for (const vec3 p : m.positions)
      m.colours.emplace_back(0.6f + 0.4f * p.x * p.z, 0.8f, 0.5f + 0.2f * p.y, 1.0f);
  };
  expectSurfacesAgree(roomOf(lambert("", vec3(0.7f)), colour), "vertex colours");
}

TEST(SurfaceAgreement, RoughPane) {
  Scene scene = roomOf(lambert("", vec3(0.7f)));
  NamedMaterial pane = glass(0.6f);
  pane.flags = kMaterialThinWalled;
  addThing(scene, "pane", pane,
           [](Mesh& m) { addQuad(m, vec3(-0.9f, 0.1f, -0.3f), vec3(0.7f, 0, 0.2f), vec3(0, 1, 0)); });
  expectSurfacesAgree(scene, "rough pane");
}

TEST(SurfaceAgreement, RoughGlass) {
  Scene scene = roomOf(lambert("", vec3(0.7f)));
  addThing(scene, "sphere", glass(0.6f), [](Mesh& m) { addSphere(m, vec3(0.3f, 0.5f, 0), 0.35f, 48, 24); });
  expectSurfacesAgree(scene, "rough glass");
}

TEST(SurfaceAgreement, AbsorbingGlass) {
  Scene scene = roomOf(lambert("", vec3(0.7f)));
  NamedMaterial dark = glass(0.0f);
  dark.baseColour = vec3(1.0f);
  dark.absorption = absorptionOf(vec3(0.2f, 0.6f, 0.8f), 0.3f);
  addThing(scene, "block", dark,
           [](Mesh& m) { addBox(m, vec3(-0.4f, 0.02f, -0.2f), vec3(0.3f, 0.6f, 0.3f)); });
  expectSurfacesAgree(scene, "absorbing glass");
}

TEST(SurfaceAgreement, Blending) {
  Scene scene = roomOf(lambert("", vec3(0.7f)));
  NamedMaterial curtain = lambert("", vec3(0.8f, 0.3f, 0.2f));
  curtain.flags = kMaterialAlphaBlend;
  curtain.alpha = 0.5f;
  addThing(scene, "curtain", curtain,
           [](Mesh& m) { addQuad(m, vec3(-0.7f, 0.4f, -0.3f), vec3(1.3f, 0, 0.2f), vec3(0, 1, 0)); });
  expectSurfacesAgree(scene, "blending");
}

TEST(SurfaceAgreement, GlossyAndColouredReflection) {
  Scene scene = roomOf(lambert("", vec3(0.7f)));
  NamedMaterial gloss = lambert("", vec3(0.3f, 0.1f, 0.1f));
  gloss.specular = 1.0f;
  gloss.roughness = 0.5f;
  gloss.ior = 2.0f;
  gloss.specularColour = vec3(0.3f, 0.9f, 0.6f);
  addThing(scene, "sphere", gloss, [](Mesh& m) { addSphere(m, vec3(-0.2f, 0.5f, 0), 0.45f, 48, 24); });
  expectSurfacesAgree(scene, "glossy and coloured reflection");
}

}  // namespace
}  // namespace isophote
