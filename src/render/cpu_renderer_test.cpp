// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "render/cpu_renderer.h"

#include "render/cpu_frame.h"
#include "support/statistics.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string_view>

namespace {

/// A buffer of a frame has a number a pixel at least; what a task or a name takes is far less.
constexpr std::size_t kBufferBytes = 16 * 1024;
std::atomic<bool> counting = false;
std::atomic<int> buffersAllocated = 0;

}  // namespace

// Replaced for this test program, to count what a frame allocates; the sanitizers have their own.
#ifndef __SANITIZE_ADDRESS__
static void* allocate(std::size_t bytes, std::size_t alignment) {
  if (counting && bytes >= kBufferBytes) ++buffersAllocated;
  void* memory = alignment == 0
                     ? std::malloc(bytes)
                     : std::aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
  if (!memory) throw std::bad_alloc();
  return memory;
}

void* operator new(std::size_t bytes) { return allocate(bytes, 0); }
void* operator new(std::size_t bytes, std::align_val_t alignment) {
  return allocate(bytes, std::size_t(alignment));
}
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }
#endif

namespace isophote {
namespace {

RenderSettings smallFrame() {
  RenderSettings settings;
  settings.frame.width = 160;
  settings.frame.height = 120;
  settings.photonTrace.photons = 3000;
  return settings;
}

bool sameBytes(const Image& a, const Image& b) {
  return a.pixels.size() == b.pixels.size() &&
         std::memcmp(a.pixels.data(), b.pixels.data(), a.pixels.size() * sizeof(vec3)) == 0;
}

bool sameBytes(const Film& a, const Film& b) {
  if (!sameBytes(a.colour, b.colour) || a.layers.size() != b.layers.size()) return false;
  for (const auto& [name, image] : a.layers)
    if (!b.layers.contains(name) || !sameBytes(image, b.layers.at(name))) return false;
  return a.metadata == b.metadata;
}

/// Mirrors, glass, emitters and glossy surfaces leave different tiles and samples behind from each side.
class CpuRendererTest : public testing::TestWithParam<const char*> {};

TEST_P(CpuRendererTest, RemembersNothingOfFormerFrames) {
  const Scene scene = loadScene(GetParam());
  const TraceScene trace(scene);
  const RenderSettings settings = smallFrame();
  Stats stats;
  const Camera front = scene.cameras.front();
  Camera side = front;
  side.eye += 0.3f * (side.target - side.eye) + vec3(0.1f, 0.05f, 0.0f);
  const Film expected = renderCpu(trace, front, settings, stats);
  CpuRenderer renderer(trace, settings);
  Film film;
  renderer.render(side, film, stats);
  EXPECT_FALSE(sameBytes(film.colour, expected.colour));
  renderer.render(front, film, stats);
  EXPECT_TRUE(sameBytes(film, expected));
}

INSTANTIATE_TEST_SUITE_P(Scenes, CpuRendererTest,
                         testing::Values("cornell-box", "glass-sphere", "caustic-ring", "atrium"),
                         [](const auto& suite) {
                           std::string name = suite.param;
                           std::erase(name, '-');
                           return name;
                         });

TEST(CpuRenderer, AllocatesNoBufferForASecondFrame) {
  if (kUnderSanitizers) GTEST_SKIP() << "the sanitizers have allocation functions of their own";
  // Of several threads one may get its first work, and with it its scratch memory, in any frame.
  const tbb::global_control alone(tbb::global_control::max_allowed_parallelism, 1);
  const Scene scene = loadScene("glass-sphere");
  const TraceScene trace(scene);
  for (const std::string_view preset : {"", "ispm", "sspm", "clusters", "directional"}) {
    SCOPED_TRACE(preset);
    RenderSettings settings = preset.empty() ? RenderSettings{} : presetSettings(preset);
    settings.frame.width = 320;
    settings.frame.height = 180;
    settings.photonTrace.photons = 20'000;
    settings.direct.lightRadius = 0.05f;
    // The automatic one looks at a few photons, copied for each frame.
    settings.photonVolumes.radius = settings.photonQuads.radius = settings.photonClusters.radius =
        settings.photonDirectional.radius = 0.1f;
    CpuRenderer renderer(trace, settings);
    Film film;
    buffersAllocated = 0;
    counting = true;
    Stats stats;
    renderer.render(scene.cameras.front(), film, stats);
    const int first = buffersAllocated.exchange(0);
    renderer.render(scene.cameras.front(), film, stats);
    counting = false;
    EXPECT_GT(first, 10);
    EXPECT_EQ(buffersAllocated, 0);
  }
}

TEST(CpuRenderer, LayersCostNothingWhereNobodyAsksForThem) {
  const Scene scene = loadScene("glass-sphere");
  const TraceScene trace(scene);
  RenderSettings settings = smallFrame();
  settings.frame.aa = 2;
  Stats stats;
  const Film with = renderCpu(trace, scene.cameras.front(), settings, stats);
  settings.frame.layers = false;
  const Film without = renderCpu(trace, scene.cameras.front(), settings, stats);
  EXPECT_EQ(with.layers.size(), 6u);
  EXPECT_TRUE(without.layers.empty());
  EXPECT_TRUE(sameBytes(with.colour, without.colour));
}

}  // namespace
}  // namespace isophote
