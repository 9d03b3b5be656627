// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/textures.h"

#include "base/error.h"
#include "scene/texture_sample.h"
#include "support/files.h"

#include <gtest/gtest.h>
#include <png.h>

#include <fstream>

namespace isophote {
namespace {

/// A PNG of one column whose red channel holds `reds` and whose other channels are 9.
std::string pngOf(const std::vector<std::uint8_t>& reds) {
  std::vector<std::uint8_t> rgb;
  for (const std::uint8_t red : reds) rgb.insert(rgb.end(), {red, 9, 9});
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = 1;
  image.height = png_uint_32(reds.size());
  image.format = PNG_FORMAT_RGB;
  std::string bytes(4096, '\0');
  png_alloc_size_t size = bytes.size();
  EXPECT_NE(png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr), 0);
  bytes.resize(size);
  return bytes;
}

class Textures : public testing::Test {
 protected:
  std::filesystem::path write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return folder_ / name;
  }
  TestFolder testFolder_;
  std::filesystem::path folder_ = testFolder_.path();
};

TEST_F(Textures, StoresTheSameUseOfTheSameFileOnce) {
  const std::filesystem::path file = write("a.png", pngOf({10, 20}));
  Scene scene;
  scene.textures.resize(1);
  TextureSet set(scene, "model.gltf");
  EXPECT_EQ(set.addFile(file, {}), 1);
  EXPECT_EQ(set.addFile(folder_ / "." / "a.png", {}), 1);
  EXPECT_EQ(set.addFile(file, {.srgb = false}), 2);
  EXPECT_EQ(set.addFile(file, {.wrapU = Wrap::kClamp}), 3);
  const std::string png = pngOf({30});
  EXPECT_EQ(set.addEncoded(std::as_bytes(std::span(png)), "image 0", {}), 4);
  EXPECT_EQ(set.addEncoded(std::as_bytes(std::span(png)), "image 0", {}), 4);
  set.decode({});
  ASSERT_EQ(scene.textures.size(), 5u);
  EXPECT_EQ(scene.textures[1].height, 2);
  EXPECT_EQ(scene.textures[1].rgba, (LargeVector<std::uint8_t>{10, 9, 9, 255, 20, 9, 9, 255}));
  EXPECT_FALSE(scene.textures[2].srgb);
  EXPECT_EQ(scene.textures[3].wrapU, Wrap::kClamp);
  EXPECT_EQ(scene.textures[4].rgba[0], 30);
}

TEST_F(Textures, TakesAlphaFromAnotherFile) {
  Scene scene;
  TextureSet set(scene, "model.obj");
  set.addFile(write("colour.png", pngOf({1, 2, 3, 4})), {}, write("alpha.png", pngOf({100, 200})));
  set.decode({});
  ASSERT_EQ(scene.textures[0].rgba.size(), 16u);
  EXPECT_EQ(scene.textures[0].rgba[3], 100);
  EXPECT_EQ(scene.textures[0].rgba[7], 100);
  EXPECT_EQ(scene.textures[0].rgba[11], 200);
  EXPECT_EQ(scene.textures[0].rgba[15], 200);
}

TEST_F(Textures, NamesModelAndFileOfTheFirstBadTexture) {
  Scene scene;
  TextureSet set(scene, "model.gltf");
  set.addFile(write("good.png", pngOf({1})), {});
  set.addFile(folder_ / "lost.png", {});
  set.addFile(write("broken.png", pngOf({1}).substr(0, 40)), {});
  try {
    set.decode({});
    FAIL();
  } catch (const Error& e) {
    const std::string what = e.what();
    EXPECT_EQ(e.kind(), ErrorKind::kBadInput);
    EXPECT_EQ(what.rfind("model.gltf: ", 0), 0u) << what;
    EXPECT_NE(what.find("lost.png is missing"), std::string::npos) << what;
  }
  Scene other;
  TextureSet broken(other, "model.gltf");
  broken.addFile(folder_ / "broken.png", {});
  EXPECT_THROW(broken.decode({}), Error);
}

TEST_F(Textures, StopsWithinItsBudget) {
  Scene scene;
  TextureSet set(scene, "model.gltf");
  set.addFile(write("a.png", pngOf(std::vector<std::uint8_t>(1000, 1))), {});
  Job job;
  job.memoryBudgetBytes = 1000;
  try {
    set.decode(job);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::kResources) << e.what();
  }
}

TEST_F(Textures, KeepsFloatsForEmissionOnly) {
  // Two texels of 4, 1/2 and 0.
  const std::string hdr = std::string("#?RADIANCE\n\n-Y 1 +X 2\n") + "\x80\x10" + std::string(1, '\0') +
                          "\x83\x80\x10" + std::string(1, '\0') + "\x83";
  const std::filesystem::path file = write("glow.hdr", hdr);
  Scene scene;
  TextureSet set(scene, "model.obj");
  EXPECT_EQ(set.addFile(file, {.emission = true}), 0);
  EXPECT_EQ(set.addFile(file, {}), 1);
  EXPECT_EQ(set.addFile(file, {.srgb = false}), 2);
  set.decode({});
  EXPECT_TRUE(scene.textures[0].rgba.empty());
  EXPECT_EQ(scene.textures[0].floats, (LargeVector<vec3>{vec3(4.0f, 0.5f, 0.0f), vec3(4.0f, 0.5f, 0.0f)}));
  EXPECT_EQ(sampleTexture(scene.textures[0], vec2(0.3f, 0.7f)), vec4(4.0f, 0.5f, 0.0f, 1.0f));
  EXPECT_EQ(scene.textures[1].rgba, (LargeVector<std::uint8_t>{255, 188, 0, 255, 255, 188, 0, 255}));
  EXPECT_EQ(scene.textures[2].rgba, (LargeVector<std::uint8_t>{255, 128, 0, 255, 255, 128, 0, 255}));
  EXPECT_NEAR(sampleTexture(scene.textures[1], vec2(0.5f)).y, 0.5f, 3e-3f);
}

}  // namespace
}  // namespace isophote
