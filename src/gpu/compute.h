// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/device.h"
#include "gpu/spirv_layout.h"

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>

namespace isophote {

/// Vulkan's guaranteed size of push constants [bytes]; no shader may want more.
inline constexpr std::uint32_t kMaxPushBytes = 128;

/// The value of one `layout(constant_id = id)`; ids are named in the stage's *.shared.h.
struct Specialization {
  std::uint32_t id;
  std::uint32_t value;
};

/// A compute shader ready to run: `ComputePipeline(device, "photon_volumes.gather",
/// shaders::photon_volumes)`. The bindings are deduced from the SPIR-V: storage buffers of set 0. Throws
/// Error(kInternal) for a shader that wants anything else and Error(kDevice) where the driver refuses it.
class ComputePipeline {
 public:
  ComputePipeline(GpuDevice& device, std::string name, std::span<const std::uint32_t> spirv,
                  std::initializer_list<Specialization> constants = {});

  const std::string& name() const { return name_; }
  const SpirvInterface& shaderInterface() const { return interface_; }
  VkPipeline handle() const { return pipeline_.get(); }
  VkPipelineLayout layout() const { return layout_.get(); }
  VkDescriptorSetLayout setLayout() const { return setLayout_.get(); }

 private:
  void createLayouts(GpuDevice& device);
  void createPipeline(GpuDevice& device, std::span<const std::uint32_t> spirv,
                      std::span<const Specialization> constants);

  std::string name_;
  SpirvInterface interface_;
  Owned<VkDescriptorSetLayout> setLayout_;
  Owned<VkPipelineLayout> layout_;
  Owned<VkPipeline> pipeline_;
};

}  // namespace isophote
