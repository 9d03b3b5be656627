// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// atrium: the scene to look at. A courtyard of 9 x 21 m between two storeys of arcades, open to the sky, with
// curtains, banners and awnings in strong colours. A lamp under the awnings lights the yard;
// everything under the vaults is lit by what those surfaces send on, so nearly all of the picture is indirect
// light, some of it coloured. Every surface is Lambertian, so that estimators can be held against the path
// tracer; the sprigs in the pots are alpha-masked, and columns, arches, vaults and balustrades are instances
// of shared meshes.
#include "scene/builtin/atrium_plan.h"
#include "scene/builtin/masonry.h"
#include "scene/builtin/patterns.h"
#include "scene/builtin/scenes.h"
#include "scene/builtin/shapes.h"

#include <array>

namespace isophote {

using namespace atrium;

namespace {

std::uint32_t addTextured(Scene& scene, NamedMaterial material, Texture texture) {
  material.baseColourTexture = int(scene.textures.size());
  scene.textures.push_back(std::move(texture));
  return addMaterial(scene, std::move(material));
}

std::uint32_t addCloth(Scene& scene, std::string name, vec3 albedo) {
  NamedMaterial cloth = lambert(std::move(name), albedo);
  cloth.flags = kMaterialDoubleSided;
  return addMaterial(scene, cloth);
}

Materials addMaterials(Scene& scene) {
  Materials m{};
  const vec3 textured(1.0f);
  m.limestone = addMaterial(scene, lambert("limestone", {0.74f, 0.68f, 0.58f}));
  m.plaster = addMaterial(scene, lambert("plaster", {0.78f, 0.74f, 0.66f}));
  m.ashlar = addTextured(scene, lambert("ashlar", textured),
                         stoneSlabs("ashlar", 512, 3, {0.68f, 0.60f, 0.47f}, {0.40f, 0.33f, 0.25f}));
  m.dado = addMaterial(scene, lambert("dado", {0.42f, 0.11f, 0.07f}));
  m.ochre = addMaterial(scene, lambert("ochre", {0.74f, 0.50f, 0.24f}));
  m.paving = addTextured(scene, lambert("paving", textured),
                         stoneSlabs("paving", 512, 2, {0.70f, 0.63f, 0.52f}, {0.34f, 0.30f, 0.24f}));
  m.chequer = addTextured(scene, lambert("chequer", textured),
                          chequer("chequer", 512, 4, {0.64f, 0.59f, 0.50f}, {0.30f, 0.13f, 0.08f}));
  m.timber = addMaterial(scene, lambert("timber", {0.25f, 0.15f, 0.08f}));
  m.roofTile = addMaterial(scene, lambert("roof tile", {0.52f, 0.22f, 0.11f}));
  m.terracotta = addMaterial(scene, lambert("terracotta", {0.56f, 0.25f, 0.13f}));
  m.bronze = addMaterial(scene, lambert("bronze", {0.16f, 0.10f, 0.05f}));
  NamedMaterial foliage = lambert("leaves", textured);
  foliage.flags = kMaterialAlphaMask | kMaterialDoubleSided;
  m.leaves = addTextured(scene, foliage, leaves("leaves", 256, {0.16f, 0.34f, 0.06f}));
  m.crimson = addCloth(scene, "crimson cloth", {0.66f, 0.035f, 0.03f});
  m.emerald = addCloth(scene, "emerald cloth", {0.03f, 0.40f, 0.12f});
  m.azure = addCloth(scene, "azure cloth", {0.03f, 0.14f, 0.60f});
  m.saffron = addCloth(scene, "saffron cloth", {0.78f, 0.47f, 0.04f});
  return m;
}

/// Texture coordinates of a floor: metres in plan, so that one pattern runs through.
void layPattern(Mesh& mesh, float metres) {
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    mesh.uvs[i] = vec2(mesh.positions[i].x, mesh.positions[i].z) / metres;
  }
}

/// A level ring of that width around a rectangle, seen from above (or from below).
void addRing(Mesh& mesh, vec2 half, float width, float height, bool fromBelow = false) {
  const std::array<ProfilePoint, 2> profile{ProfilePoint{fromBelow ? 0 : width, height},
                                            ProfilePoint{fromBelow ? width : 0, height}};
  addMoulding(mesh, profile, half);
}

/// Upright faces around a rectangle, seen from inside it.
void addInnerWalls(Mesh& mesh, vec2 half, float from, float to) {
  const std::array<ProfilePoint, 2> profile{ProfilePoint{0, from}, ProfilePoint{0, to}};
  addMoulding(mesh, profile, half, true);
}

void addGround(Scene& scene, const Materials& m) {
  const vec2 yard = kAxes - 0.8f;
  Mesh paving, steps, arcade, gallery;
  addQuad(paving, {-yard.x, 0, yard.y}, {2.0f * yard.x, 0, 0}, {0, 0, -2.0f * yard.y});
  layPattern(paving, 2.4f);
  addObject(scene, "paving", m.paving, std::move(paving));
  for (const float step : {0.0f, 1.0f}) {
    const vec2 half = yard + 0.3f * step;
    addInnerWalls(steps, half, 0.5f * kFloor * step, 0.5f * kFloor * (step + 1.0f));
    if (step == 0.0f) addRing(steps, half, 0.3f, 0.5f * kFloor);
  }
  addObject(scene, "steps", m.limestone, std::move(steps));
  addRing(arcade, yard + 0.3f, kWalls.x - yard.x - 0.3f, kFloor);
  layPattern(arcade, 2.0f);
  addObject(scene, "arcade floor", m.chequer, std::move(arcade));
  addRing(gallery, kAxes - 0.3f, kBay + 0.3f, kGallery);
  addObject(scene, "gallery floor", m.terracotta, std::move(gallery));
}

void addBackWalls(Scene& scene, const Materials& m) {
  constexpr float kDado = kFloor + 1.1f;
  Mesh dado, lower, upper, rail, outside;
  addInnerWalls(dado, kWalls, kFloor, kDado);
  addObject(scene, "dado", m.dado, std::move(dado));
  addInnerWalls(lower, kWalls, kDado, kGallery);
  scaleUvs(lower, 2.4f);
  addObject(scene, "lower wall", m.ashlar, std::move(lower));
  addInnerWalls(upper, kWalls, kGallery, kCeiling);
  addObject(scene, "upper wall", m.ochre, std::move(upper));
  std::vector<ProfilePoint> profile{{0, kDado - 0.05f},     {0.05f, kDado},         {0.05f, kDado},
                                    {0.05f, kDado + 0.04f}, {0.05f, kDado + 0.04f}, {0, kDado + 0.05f}};
  addMoulding(rail, profile, kWalls, true);
  addObject(scene, "dado rail", m.limestone, std::move(rail));
  const std::array<ProfilePoint, 2> upright{ProfilePoint{0.4f, 0}, ProfilePoint{0.4f, kEaves + 1.1f}};
  addMoulding(outside, upright, kWalls);
  addObject(scene, "outer wall", m.limestone, std::move(outside));
}

/// Half ring under the vaults at a bay's edge, with the pilaster at the back wall that carries it.
Mesh makeTransverseArch() {
  Mesh mesh;
  addTransverseArch(
      mesh, {.radius = 1.38f, .thickness = 0.14f, .width = 0.34f, .springing = kSpringing, .segments = 20});
  const float wall = -0.5f * kBay;
  addBox(mesh, {-0.17f, kFloor, wall}, {0.17f, kSpringing - 0.16f, wall + 0.12f});
  addBox(mesh, {-0.21f, kFloor, wall}, {0.21f, kFloor + 0.22f, wall + 0.16f});
  addBox(mesh, {-0.22f, kSpringing - 0.16f, wall}, {0.22f, kSpringing, wall + 0.17f});
  return mesh;
}

void addLowerStorey(Scene& scene, const Materials& m) {
  Mesh column, arch, vault;
  addColumn(column, {.height = kSpringing - kFloor, .radius = 0.21f, .abacus = 0.37f, .slices = 24});
  addArchWall(arch, {.width = kBay,
                     .radius = 1.15f,
                     .springing = kSpringing,
                     .top = kGallery,
                     .depth = kLowerDepth,
                     .archivolt = 0.24f,
                     .segments = 20});
  addGroinVault(vault, 0.5f * kBay, kSpringing, 16);
  const auto columnMesh = addMesh(scene, "lower column", m.limestone, std::move(column));
  const auto archMesh = addMesh(scene, "lower arch", m.limestone, std::move(arch));
  const auto vaultMesh = addMesh(scene, "vault", m.plaster, std::move(vault));
  const auto transverseMesh = addMesh(scene, "transverse arch", m.limestone, makeTransverseArch());
  for (const Side& side : kSides) {
    for (int i = 0; i <= side.bays; ++i) {
      const float x = side.left() + kBay * float(i);
      addInstance(scene, "transverse arch", transverseMesh, side.at(x, 0, -0.5f * kBay));
      if (i > 0 && i < side.bays) addInstance(scene, "lower column", columnMesh, side.at(x, kFloor, 0));
      // The bay to the right of this line; beyond the last column lies the corner's vault.
      addInstance(scene, "vault", vaultMesh, side.at(x + 0.5f * kBay, 0, -0.5f * kBay));
      if (i < side.bays) addInstance(scene, "lower arch", archMesh, side.at(x + 0.5f * kBay, 0, 0));
    }
  }
}

void addUpperStorey(Scene& scene, const Materials& m) {
  constexpr float kHalfBay = 0.5f * kBay;
  Mesh column, arch, balustrade;
  addColumn(column, {.height = kUpperSpringing - kGallery,
                     .radius = 0.115f,
                     .abacus = 0.205f,
                     .slices = 12,
                     .arcSteps = 2});
  addArchWall(arch, {.width = kHalfBay,
                     .radius = 0.56f,
                     .springing = kUpperSpringing,
                     .top = kCeiling,
                     .depth = kUpperDepth,
                     .archivolt = 0.13f,
                     .segments = 12});
  addBalustrade(balustrade, {.length = kHalfBay - 0.22f, .height = 0.9f, .balusters = 5, .slices = 8});
  const auto columnMesh = addMesh(scene, "upper column", m.limestone, std::move(column));
  const auto archMesh = addMesh(scene, "upper arch", m.limestone, std::move(arch));
  const auto balustradeMesh = addMesh(scene, "balustrade", m.limestone, std::move(balustrade));
  for (const Side& side : kSides) {
    for (int i = 0; i < 2 * side.bays; ++i) {
      const float x = side.left() + kHalfBay * float(i);
      if (i > 0) addInstance(scene, "upper column", columnMesh, side.at(x, kGallery, 0));
      addInstance(scene, "upper arch", archMesh, side.at(x + 0.5f * kHalfBay, 0, 0));
      addInstance(scene, "balustrade", balustradeMesh, side.at(x + 0.5f * kHalfBay, kGallery, 0));
    }
  }
}

/// The square piers at the four corners of the yard, through both storeys.
void addPiers(Scene& scene, const Materials& m) {
  constexpr float kHalf = 0.48f;
  std::vector<ProfilePoint> profile;
  const auto edge = [&](float out, float height) { profile.insert(profile.end(), 2, {out, height}); };
  profile.push_back({0.1f, kFloor});
  edge(0.1f, kFloor + 0.2f);
  addArc(profile, {0.05f, kFloor + 0.26f}, 0.05f, -90, 90, 4);
  edge(0, kFloor + 0.36f);
  edge(0, kSpringing - 0.2f);
  edge(0.06f, kSpringing - 0.1f);
  edge(0.06f, kSpringing);
  edge(0, kSpringing);
  edge(0, kUpperSpringing - 0.16f);
  edge(0.05f, kUpperSpringing - 0.08f);
  edge(0.05f, kUpperSpringing);
  edge(0, kUpperSpringing);
  profile.push_back({0, kCeiling});
  Mesh pier;
  addMoulding(pier, profile, vec2(kHalf));
  const auto mesh = addMesh(scene, "pier", m.limestone, std::move(pier));
  for (const float x : {-kAxes.x, kAxes.x}) {
    for (const float z : {-kAxes.y, kAxes.y}) addInstance(scene, "pier", mesh, turnedAndMoved(0, {x, 0, z}));
  }
}

/// The string course between the storeys and the cornice under the eaves.
void addCornices(Scene& scene, const Materials& m) {
  Mesh mesh;
  std::vector<ProfilePoint> course{{0, kGallery - 0.3f}, {0.03f, kGallery - 0.3f}, {0.03f, kGallery - 0.3f}};
  course.push_back({0.03f, kGallery - 0.2f});
  addArc(course, {0.13f, kGallery - 0.2f}, 0.1f, 180, 90, 5);
  course.push_back({0.17f, kGallery - 0.1f});
  course.insert(course.end(), 2, {0.17f, kGallery - 0.1f});
  course.insert(course.end(), 2, {0.17f, kGallery});
  course.push_back({-0.1f, kGallery});
  addMoulding(mesh, course, kAxes - 0.5f * kLowerDepth, true);

  std::vector<ProfilePoint> cornice{{-0.1f, kCeiling}, {0.05f, kCeiling}, {0.05f, kCeiling}};
  cornice.insert(cornice.end(), 2, {0.05f, kCeiling + 0.1f});
  addArc(cornice, {0.05f, kCeiling + 0.25f}, 0.15f, -90, 0, 5);
  cornice.insert(cornice.end(), 2, {0.28f, kCeiling + 0.28f});
  cornice.insert(cornice.end(), 2, {0.28f, kEaves - 0.1f});
  cornice.push_back({0.33f, kEaves});
  addMoulding(mesh, cornice, kAxes - 0.5f * kUpperDepth, true);
  addObject(scene, "cornices", m.limestone, std::move(mesh));
}

/// Gallery ceiling with beams, and the roof over it.
void addRoof(Scene& scene, const Materials& m) {
  constexpr float kSpacing = 0.75f;
  Mesh ceiling, beams, roof;
  addRing(ceiling, kAxes, kBay, kCeiling, true);
  addObject(scene, "gallery ceiling", m.plaster, std::move(ceiling));
  const auto beam = [&](const Side& side, float x) {
    Mesh box;
    addBox(box, {-0.06f, kCeiling - 0.18f, -kBay}, {0.06f, kCeiling, -0.5f * kUpperDepth});
    transform(box, side.at(x, 0, 0));
    append(beams, box);
  };
  for (const Side& side : kSides) {
    const int count = int(kBay * float(side.bays) / kSpacing);
    for (int i = 0; i < count; ++i) beam(side, side.left() + kSpacing * (float(i) + 0.5f));
  }
  addObject(scene, "beams", m.timber, std::move(beams));
  const vec2 eaves = kAxes - 0.5f * kUpperDepth - 0.33f;
  const float width = kWalls.x + 0.4f - eaves.x;
  const std::array<ProfilePoint, 2> slope{ProfilePoint{width, kEaves + 1.1f}, ProfilePoint{0, kEaves}};
  addMoulding(roof, slope, eaves);
  addObject(scene, "roof", m.roofTile, std::move(roof));
}

}  // namespace

Scene makeAtrium() {
  Scene scene;
  scene.name = "atrium";
  const Materials materials = addMaterials(scene);
  addGround(scene, materials);
  addBackWalls(scene, materials);
  addLowerStorey(scene, materials);
  addUpperStorey(scene, materials);
  addPiers(scene, materials);
  addCornices(scene, materials);
  addRoof(scene, materials);
  addFurnishings(scene, materials);

  // A lamp high in the yard instead of the sun, whose photons would nearly all be spent on the roofs.
  Light lamp{};
  lamp.type = kLightPoint;
  lamp.position = {-0.9f, 7.4f, -1.6f};
  lamp.colour = {60.0f, 53.0f, 42.0f};
  scene.lights.push_back(lamp);

  scene.cameras.push_back(
      {.name = "yard", .eye = {-2.6f, 1.8f, 11.0f}, .target = {0.6f, 1.95f, -4}, .verticalFovDegrees = 43});
  scene.cameras.push_back(
      {.name = "arcade", .eye = {-6.2f, 1.9f, 11.5f}, .target = {-5.0f, 2.2f, 0}, .verticalFovDegrees = 55});
  scene.cameras.push_back(
      {.name = "gallery", .eye = {-4.4f, 6.75f, 5.25f}, .target = {3, 2.6f, -3}, .verticalFovDegrees = 55});
  return scene;
}

}  // namespace isophote
