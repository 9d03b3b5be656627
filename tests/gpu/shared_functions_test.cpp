// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/shared_functions.shared.h"

#include "gpu/command_list.h"
#include "shaders/shared_functions.h"
#include "support/gpu_test.h"
#include "support/shader_layout.h"

#include <algorithm>
#include <cmath>

namespace isophote {
namespace {

constexpr std::uint32_t kCount = 1000;
constexpr std::uint32_t kSeed = 7;

std::vector<Material> someMaterials() {
  std::vector<Material> materials(kCount, makeMaterial());
  for (uint i = 0; i < kCount; ++i) {
    const vec3 u = random3(kSeed, i, 1u);
    const vec3 v = random3(kSeed, i, 2u);
    materials[i].baseColour = u;
    materials[i].metallic = v.x;
    // Away from mirrors: there a last-bit difference in direction is a large one in value.
    materials[i].roughness = 0.3f + 0.7f * v.y;
    materials[i].transmission = i % 4 == 0 ? v.z : 0.0f;
  }
  return materials;
}

std::vector<Photon> somePhotons() {
  std::vector<Photon> photons(kCount);
  for (uint i = 0; i < kCount; ++i) {
    const vec3 u = random3(kSeed, i, 3u);
    const vec3 v = random3(kSeed, i, 4u);
    photons[i] = {.position = v,
                  .pathDensity = 1e-3f,
                  .power = u,
                  .direction = packDirection(sampleSphere(vec2(u.x, u.y))),
                  .normal = packDirection(sampleSphere(vec2(v.x, v.y))),
                  .bounce = 1};
  }
  return photons;
}

SharedFunctionsPush pushConstants() {
  SharedFunctionsPush push{};
  push.camera.eye = vec3(1.0f, 2.0f, 3.0f);
  push.camera.forward = vec3(0.0f, 0.0f, -1.0f);
  push.camera.right = vec3(0.7f, 0.0f, 0.0f);
  push.camera.up = vec3(0.0f, 0.5f, 0.0f);
  push.seed = kSeed;
  push.count = kCount;
  return push;
}

/// Vulkan lets sin and cos err by 2^-11; values grow that by their own size.
void expectClose(float gpu, float cpu, std::string_view what, uint index) {
  EXPECT_NEAR(gpu, cpu, 1e-3f * std::max(1.0f, std::abs(cpu))) << what << " of element " << index;
}

void expectClose(vec3 gpu, vec3 cpu, std::string_view what, uint index) {
  for (int axis = 0; axis < 3; ++axis) expectClose(gpu[axis], cpu[axis], what, index);
}

void expectSame(const SharedFunctionsResult& gpu, const SharedFunctionsResult& cpu, uint i) {
  EXPECT_EQ(gpu.key, cpu.key) << i;
  EXPECT_EQ(gpu.sobol, cpu.sobol) << i;
  expectClose(unpackDirection(gpu.packed), unpackDirection(cpu.packed), "packDirection", i);
  expectClose(gpu.hemisphere, cpu.hemisphere, "sampleCosineHemisphere", i);
  expectClose(gpu.unpacked, cpu.unpacked, "unpackDirection", i);
  expectClose(gpu.bsdf, cpu.bsdf, "evalBsdf", i);
  expectClose(gpu.pdf, cpu.pdf, "pdfBsdf", i);
  expectClose(gpu.kernel, cpu.kernel, "kernelValue", i);
  expectClose(gpu.lightPdf, cpu.lightPdf, "areaSamplePdf", i);
  expectClose(gpu.cameraDirection, cpu.cameraDirection, "cameraRayDirection", i);
  expectClose(gpu.spread, cpu.spread, "sampleBsdf", i);
}

class SharedFunctions : public GpuTest {};

TEST_F(SharedFunctions, AreTheSameOnTheGpu) {
  const std::vector<Material> materials = someMaterials();
  const std::vector<Photon> photons = somePhotons();
  const SharedFunctionsPush push = pushConstants();
  const ComputePipeline pipeline(device(), "shared_functions", shaders::shared_functions,
                                 {{kSpecKernel, kKernelEpanechnikov}});
  const GpuArray<Material> gpuMaterials(device(), "shared_functions.materials", materials);
  const GpuArray<Photon> gpuPhotons(device(), "shared_functions.photons", photons);
  const GpuArray<SharedFunctionsResult> results(device(), "shared_functions.results", kCount);

  CommandList list(device(), "shared_functions");
  list.use(pipeline);
  list.bind(kBindMaterials, gpuMaterials);
  list.bind(kBindPhotons, gpuPhotons);
  list.bind(kBindResults, results);
  list.push(push);
  list.dispatchItems(kCount);
  list.submitAndWait();

  const std::vector<SharedFunctionsResult> gpu = results.download();
  uint otherLobes = 0;
  for (uint i = 0; i < kCount; ++i) {
    const SharedFunctionsResult cpu =
        sharedFunctions(materials[i], photons[i], push.camera, kSeed, i, kKernelEpanechnikov);
    // A random number next to the border of two lobes may fall on either side.
    if (gpu[i].lobe != cpu.lobe)
      ++otherLobes;
    else
      expectSame(gpu[i], cpu, i);
  }
  EXPECT_LE(otherLobes, kCount / 1000);
}

TEST(ShaderLayout, StructsLieInBuffersAsInCpp) {
  const auto words = shaders::shared_functions;
  expectSameOffsets(words, "Photon", sizeof(Photon),
                    {{"position", offsetof(Photon, position)},
                     {"pathDensity", offsetof(Photon, pathDensity)},
                     {"power", offsetof(Photon, power)},
                     {"direction", offsetof(Photon, direction)},
                     {"normal", offsetof(Photon, normal)},
                     {"bounce", offsetof(Photon, bounce)}});
  expectSameOffsets(words, "CameraRays", sizeof(CameraRays),
                    {{"eye", offsetof(CameraRays, eye)},
                     {"orthographic", offsetof(CameraRays, orthographic)},
                     {"forward", offsetof(CameraRays, forward)},
                     {"pad0", offsetof(CameraRays, pad0)},
                     {"right", offsetof(CameraRays, right)},
                     {"pad1", offsetof(CameraRays, pad1)},
                     {"up", offsetof(CameraRays, up)},
                     {"pad2", offsetof(CameraRays, pad2)}});
  expectSameOffsets(words, "SharedFunctionsPush", sizeof(SharedFunctionsPush),
                    {{"camera", offsetof(SharedFunctionsPush, camera)},
                     {"seed", offsetof(SharedFunctionsPush, seed)},
                     {"count", offsetof(SharedFunctionsPush, count)}});
}

TEST(ShaderLayout, MaterialLiesInBuffersAsInCpp) {
  expectSameOffsets(shaders::shared_functions, "Material", sizeof(Material),
                    {{"baseColour", offsetof(Material, baseColour)},
                     {"metallic", offsetof(Material, metallic)},
                     {"emission", offsetof(Material, emission)},
                     {"roughness", offsetof(Material, roughness)},
                     {"transmission", offsetof(Material, transmission)},
                     {"ior", offsetof(Material, ior)},
                     {"specular", offsetof(Material, specular)},
                     {"alpha", offsetof(Material, alpha)},
                     {"alphaCutoff", offsetof(Material, alphaCutoff)},
                     {"flags", offsetof(Material, flags)},
                     {"baseColourTexture", offsetof(Material, baseColourTexture)},
                     {"metallicRoughnessTexture", offsetof(Material, metallicRoughnessTexture)},
                     {"emissionTexture", offsetof(Material, emissionTexture)},
                     {"normalTexture", offsetof(Material, normalTexture)},
                     {"normalScale", offsetof(Material, normalScale)},
                     {"transmissionTexture", offsetof(Material, transmissionTexture)},
                     {"specularColour", offsetof(Material, specularColour)},
                     {"specularTexture", offsetof(Material, specularTexture)},
                     {"absorption", offsetof(Material, absorption)},
                     {"specularColourTexture", offsetof(Material, specularColourTexture)}});
}

}  // namespace
}  // namespace isophote
