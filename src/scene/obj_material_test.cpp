// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/obj_material.h"

#include "support/files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace isophote {
namespace {

using testing::HasSubstr;

MtlMaterial parseOne(const std::string& terms, const Job& job = {}) {
  return parseMtl("newmtl m\n" + terms, "m.mtl", job).at(0);
}

Material materialOf(const std::string& terms) { return materialFromMtl(parseOne(terms)); }

/// Reflectance at normal incidence of the dielectric that a material describes.
float f0Of(const Material& m) {
  const float ratio = (m.ior - 1.0f) / (m.ior + 1.0f);
  return m.specular * ratio * ratio;
}

void expectNear(vec3 a, vec3 b) { EXPECT_LT(length(a - b), 1e-5f) << a.x << " " << a.y << " " << a.z; }

TEST(ObjMaterial, ParsesEveryTerm) {
  const std::string text =
      "# library\nnewmtl first one\n\tKd 0.1 0.2 0.3 # comment\n Ks 0.4\nKe 1 2 3\nTf 0.5 0.6 0.7\nNs 8\nNi "
      "1.5\n"
      "d 0.25\nTr 0.9\nillum 7\nmap_Kd -o 1 2 -blendu off a b.png\nmap_d c.png\nmap_Ke -clamp on e.png\n"
      "map_Ks s.png\nmap_Ns n.png\nmap_bump -bm 0.5 h.png\nnorm t.png\n"
      "newmtl second\nTr 0.25\n";
  const std::vector<MtlMaterial> all = parseMtl(text, "m.mtl");
  ASSERT_EQ(all.size(), 2u);
  const MtlMaterial& m = all[0];
  EXPECT_EQ(m.name, "first one");
  EXPECT_EQ(*m.kd, vec3(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(*m.ks, vec3(0.4f));
  EXPECT_EQ(*m.ke, vec3(1, 2, 3));
  EXPECT_EQ(*m.tf, vec3(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(*m.ns, 8.0f);
  EXPECT_EQ(*m.ni, 1.5f);
  EXPECT_EQ(*m.d, 0.25f) << "d wins over Tr";
  EXPECT_EQ(*m.illum, 7);
  EXPECT_EQ(m.mapKd.file, "a b.png");
  EXPECT_EQ(m.mapD.file, "c.png");
  EXPECT_TRUE(m.mapKe.clamp);
  EXPECT_EQ(m.mapKs.file, "s.png");
  EXPECT_EQ(m.mapNs.file, "n.png");
  EXPECT_EQ(m.bump.file, "h.png");
  EXPECT_EQ(m.bump.bump, 0.5f);
  EXPECT_EQ(m.norm.file, "t.png");
  EXPECT_EQ(*all[1].d, 0.75f) << "without d, Tr counts";
  EXPECT_FALSE(all[1].kd.has_value());
}

TEST(ObjMaterial, WarnsOnceOfWhatItIgnores) {
  WarningLog log;
  parseOne("Ka 1 1 1\ndisp s.png\ndisp t.png\nKd spectral file.rfl 1\n", log.job());
  ASSERT_EQ(log.warnings.size(), 1u);
  EXPECT_EQ(log.warnings[0], "m.mtl: not supported and ignored: Kd spectral, disp");
}

TEST(ObjMaterial, NamesLineOfBadTerms) {
  const auto errorOfTerm = [](const std::string& term) { return errorOf([&] { parseOne(term); }); };
  EXPECT_THAT(errorOfTerm("Kd 0 nan 0\n"),
              HasSubstr("m.mtl: line 2: Kd must be a finite number, not \"nan\""));
  EXPECT_THAT(errorOfTerm("Ke 1 2\n"), HasSubstr("Ke is missing"));
  EXPECT_THAT(errorOfTerm("Kd -1 0 0\n"), HasSubstr("Kd must not be negative"));
  EXPECT_THAT(errorOfTerm("Ns high\n"), HasSubstr("Ns must be a finite number"));
  EXPECT_THAT(errorOfTerm("illum 2.5\n"), HasSubstr("illum must be a whole number"));
  EXPECT_THAT(errorOfTerm("map_Kd -clamp on\n"), HasSubstr("map_Kd names no file"));
  EXPECT_THAT(errorOf([] { parseMtl("Kd 1 1 1\n", "m.mtl"); }), HasSubstr("before the first newmtl"));
}

TEST(ObjMaterial, MattSurfacesDoNotReflect) {
  for (const char* terms : {"Kd 0.2 0.4 0.6\n", "Kd 0.2 0.4 0.6\nKs 0 0 0\nNs 60\nillum 2\n",
                            "Kd 0.2 0.4 0.6\nKs 1 1 1\nillum 1\n"}) {
    const Material m = materialOf(terms);
    EXPECT_EQ(m.baseColour, vec3(0.2f, 0.4f, 0.6f));
    EXPECT_EQ(m.specular, 0.0f);
    EXPECT_EQ(m.metallic, 0.0f);
    EXPECT_EQ(m.transmission, 0.0f);
    EXPECT_EQ(m.flags, kMaterialDoubleSided);
  }
}

TEST(ObjMaterial, HighlightsReflectKsAtNormalIncidence) {
  const Material m = materialOf("Kd 0.4 0.4 0.4\nKs 0.25 0.25 0.25\nNs 30\nNi 1.1\nillum 2\n");
  EXPECT_NEAR(f0Of(m), 0.25f, 1e-5f);
  EXPECT_NEAR(m.ior, 3.0f, 1e-5f);
  EXPECT_NEAR(m.roughness * m.roughness, 0.25f, 1e-6f) << "sqrt(2 / 32)";
  EXPECT_EQ(m.transmission, 0.0f);
  EXPECT_NEAR(f0Of(materialOf("Ks 5 5 5\nillum 2\n")), 0.98f, 1e-4f);
}

TEST(ObjMaterial, MirrorsAreMetals) {
  const Material rough = materialOf("Kd 0 0 0\nKs 0.9 0.8 0.4\nNs 30\nillum 3\n");
  EXPECT_EQ(rough.metallic, 1.0f);
  EXPECT_EQ(rough.baseColour, vec3(0.9f, 0.8f, 0.4f));
  EXPECT_NEAR(rough.roughness, 0.5f, 1e-6f);
  const Material mirror = materialOf("Kd 0.01 0.01 0.01\nKs 0.95 0.95 0.95\nNs 1000\nillum 5\n");
  EXPECT_EQ(mirror.metallic, 1.0f);
  EXPECT_LE(mirror.roughness, kMirrorRoughness);
  EXPECT_LE(materialOf("Kd 0 0 0\nKs 1 1 1\nillum 3\n").roughness, kMirrorRoughness);
  EXPECT_EQ(materialOf("Kd 0.5 0.5 0.5\nillum 3\n").metallic, 0.0f) << "nothing reflects without Ks";
}

TEST(ObjMaterial, PolishedSurfacesKeepTheirDiffusePart) {
  const Material m = materialOf("Kd 0.3 0.3 0.3\nKs 0.6 0.6 0.6\nNs 100\nillum 3\n");
  expectNear(m.baseColour * (1.0f - m.metallic), vec3(0.3f));
  expectNear(m.baseColour * m.metallic, vec3(0.6f));
  EXPECT_EQ(m.specular, 0.0f);
}

TEST(ObjMaterial, GlassRefracts) {
  const Material m = materialOf("Kd 0 0 0\nKs 1 1 1\nTf 0.9 1 0.9\nNi 1.52\nNs 1000\nd 0\nillum 7\n");
  EXPECT_EQ(m.transmission, 1.0f);
  EXPECT_EQ(m.ior, 1.52f);
  EXPECT_EQ(m.roughness, 0.0f);
  EXPECT_EQ(m.specular, 1.0f);
  EXPECT_EQ(m.baseColour, vec3(0.9f, 1.0f, 0.9f));
  EXPECT_EQ(m.flags & kMaterialThinWalled, 0u);
  const Material byDissolve = materialOf("Kd 0.5 0.6 0.5\nNi 1.5\nd 0.3\nillum 2\n");
  EXPECT_EQ(byDissolve.transmission, 1.0f);
  EXPECT_EQ(byDissolve.baseColour, vec3(1.0f));
  EXPECT_EQ(materialOf("illum 4\n").ior, 1.5f);
  EXPECT_EQ(materialOf("Tf 0 0 0\nillum 7\n").baseColour, vec3(1.0f));
}

TEST(ObjMaterial, FilmsLetLightThroughStraight) {
  const Material m = materialOf("Kd 0.8 0.2 0.2\nd 0.25\nillum 1\n");
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_EQ(m.ior, 1.0f);
  EXPECT_EQ(m.specular, 0.0f);
  EXPECT_TRUE(m.flags & kMaterialThinWalled);
}

TEST(ObjMaterial, LampsEmitToTheirFront) {
  const Material m = materialOf("Kd 0.8 0.8 0.8\nKe 17 12 4\n");
  EXPECT_EQ(m.emission, vec3(17, 12, 4));
  EXPECT_EQ(m.flags & kMaterialDoubleSided, 0u);
  EXPECT_EQ(materialOf("map_Ke e.png\nKe 0 0 0\n").emission, vec3(1.0f));
}

}  // namespace
}  // namespace isophote
