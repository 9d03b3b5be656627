// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "stages/photon_volumes/photon_volumes_vulkan.h"

#include "shaders/photon_volumes.h"
#include "stages/photon_volumes/photon_volumes.shared.h"
#include "stages/photon_volumes/test_view.h"
#include "support/gpu_test.h"
#include "support/shader_layout.h"

#include <cmath>

namespace isophote {
namespace {

using namespace photon_volumes_test;

constexpr float kRadius = 0.12f;

#define MEMBER(Struct, member) \
  { #member, std::uint32_t(offsetof(Struct, member)) }

TEST(PhotonVolumesShader, LaysOutItsStructsAsCppDoes) {
  using V = ViewTile;
  expectSameOffsets(
      shaders::photon_volumes, "ViewTile", sizeof(V),
      {MEMBER(V, positionX),     MEMBER(V, positionY),   MEMBER(V, positionZ),     MEMBER(V, ngX),
       MEMBER(V, ngY),           MEMBER(V, ngZ),         MEMBER(V, nsX),           MEMBER(V, nsY),
       MEMBER(V, nsZ),           MEMBER(V, woX),         MEMBER(V, woY),           MEMBER(V, woZ),
       MEMBER(V, diffuseR),      MEMBER(V, diffuseG),    MEMBER(V, diffuseB),      MEMBER(V, pixel),
       MEMBER(V, f0R),           MEMBER(V, f0G),         MEMBER(V, f0B),           MEMBER(V, f90),
       MEMBER(V, alpha),         MEMBER(V, coupling0),   MEMBER(V, coupling90),    MEMBER(V, throughputR),
       MEMBER(V, throughputG),   MEMBER(V, throughputB), MEMBER(V, transmissionR), MEMBER(V, transmissionG),
       MEMBER(V, transmissionB), MEMBER(V, through),     MEMBER(V, ior),           MEMBER(V, sides),
       MEMBER(V, bounds),        MEMBER(V, count),       MEMBER(V, lambertian),    MEMBER(V, unitThroughput),
       MEMBER(V, transmits),     MEMBER(V, reserved)});
  expectSameOffsets(shaders::photon_volumes, "Bounds", sizeof(Bounds),
                    {MEMBER(Bounds, lower), MEMBER(Bounds, upper)});
  using P = PhotonVolume;
  expectSameOffsets(shaders::photon_volumes, "PhotonVolume", sizeof(P),
                    {MEMBER(P, position), MEMBER(P, inverseRadius2), MEMBER(P, normal), MEMBER(P, normalTerm),
                     MEMBER(P, direction), MEMBER(P, radius), MEMBER(P, weightedPower), MEMBER(P, reserved)});
  using R = RadianceTile;
  expectSameOffsets(shaders::photon_volumes, "RadianceTile", sizeof(R),
                    {MEMBER(R, r), MEMBER(R, g), MEMBER(R, b)});
  using Push = PhotonVolumesPush;
  expectSameOffsets(shaders::photon_volumes, "PhotonVolumesPush", sizeof(Push),
                    {MEMBER(Push, kernel), MEMBER(Push, lastPart)});
}

class PhotonVolumesVulkanTest : public GpuTest {
 protected:
  /// Runs both engines on the same input: 99.9 % of the values differ by no more than 1e-3 of the CPU's.
  void expectAgreement(const ViewSamples& view, const PhotonMap& map, PhotonVolumesSettings settings,
                       float radius = kRadius, const Job& job = {}) {
    PhotonVolumesVulkan onDevice(device(), settings);
    expectAgreement(onDevice, view, map, settings, radius, job);
  }

  void expectAgreement(PhotonVolumesVulkan& onDevice, const ViewSamples& view, const PhotonMap& map,
                       PhotonVolumesSettings settings, float radius = kRadius, const Job& job = {}) {
    Radiance expected;
    Radiance got;
    Stats cpu;
    Stats gpu;
    PhotonVolumes(settings).run({view, map, radius}, expected, cpu);
    onDevice.run({view, map, radius}, got, gpu, job);
    ASSERT_EQ(got.size(), expected.size());
    std::size_t differ = 0;
    std::size_t lit = 0;
    for (std::size_t i = 0; i < got.size(); ++i)
      for (int lane = 0; lane < kTileLanes; ++lane) {
        const float pairs[3][2] = {{got[i].r[lane], expected[i].r[lane]},
                                   {got[i].g[lane], expected[i].g[lane]},
                                   {got[i].b[lane], expected[i].b[lane]}};
        for (const auto& [a, b] : pairs) {
          lit += b > 0.0f;
          differ += !(std::abs(a - b) <= 1e-3f * b);
        }
      }
    EXPECT_LE(double(differ), 1e-3 * double(lit)) << differ << " of " << lit;
    if (!map.photons.empty()) {
      EXPECT_GT(double(lit), 0.3 * double(got.size()) * kTileLanes * 3);
    }
    EXPECT_EQ(gpu.counter("photon_volumes.pairsTested"), cpu.counter("photon_volumes.pairsTested"));
    // A pair at the rim may fall on either side.
    EXPECT_NEAR(gpu.counter("photon_volumes.pairsContributing"),
                cpu.counter("photon_volumes.pairsContributing"),
                1e-3 * cpu.counter("photon_volumes.pairsContributing"));
  }
};

TEST_F(PhotonVolumesVulkanTest, AgreesWithTheCpu) {
  const ViewSamples view = makeView({.width = 80, .height = 60, .secondaryTiles = 70});
  for (const Kernel kernel : {Kernel::kConstant, Kernel::kEpanechnikov}) {
    PhotonVolumesSettings settings;
    settings.kernel = kernel;
    expectAgreement(view, makePhotons(2000), settings);
  }
}

TEST_F(PhotonVolumesVulkanTest, AgreesInSeveralWindowsPartsAndPasses) {
  // More than 64 blocks of tiles; more than 4096 photons in a block; a budget for less than all photons.
  const ViewSamples wide = makeView({.width = 4200, .height = 9, .lambertian = true});
  expectAgreement(wide, makePhotons(300), {});
  const ViewSamples small = makeView({.width = 16, .height = 16});
  expectAgreement(small, makePhotons(9000), {}, 0.5f);
  Job job;
  job.memoryBudgetBytes = 1 << 16;
  expectAgreement(makeView({.width = 24, .height = 16, .secondaryTiles = 70}), makePhotons(3000), {}, kRadius,
                  job);
}

TEST_F(PhotonVolumesVulkanTest, KeepsNothingOfARunBefore) {
  PhotonVolumesVulkan onDevice(device(), {});
  const ViewSamples view = makeView({.width = 40, .height = 32});
  expectAgreement(onDevice, view, makePhotons(1000), {});
  expectAgreement(onDevice, makeView({.width = 20, .height = 9, .seed = 5}), makePhotons(2000, 8), {});
  expectAgreement(onDevice, view, PhotonMap{}, {});
  expectAgreement(onDevice, view, makePhotons(1000), {});
}

}  // namespace
}  // namespace isophote
