// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/compute.h"

#include <cstddef>
#include <vector>

namespace isophote {

ComputePipeline::ComputePipeline(GpuDevice& device, std::string name, std::span<const std::uint32_t> spirv,
                                 std::initializer_list<Specialization> constants)
    : name_(std::move(name)), interface_(readSpirv(name_, spirv)) {
  for (const SpirvBinding& binding : interface_.bindings)
    if (binding.kind != SpirvBindingKind::kStorageBuffer || binding.set != 0)
      fail(ErrorKind::kInternal, name_, "binding {} ({}) is not a storage buffer of set 0", binding.binding,
           binding.name);
  createLayouts(device);
  createPipeline(device, spirv, constants);
}

void ComputePipeline::createLayouts(GpuDevice& device) {
  const VolkDeviceTable& vk = device.vk();
  std::vector<VkDescriptorSetLayoutBinding> bindings;
  for (const SpirvBinding& binding : interface_.bindings)
    bindings.push_back(
        {binding.binding, VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, 1, VK_SHADER_STAGE_COMPUTE_BIT, nullptr});
  auto setInfo =
      vkStruct<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
  setInfo.bindingCount = static_cast<std::uint32_t>(bindings.size());
  setInfo.pBindings = bindings.data();
  VkDescriptorSetLayout setLayout = VK_NULL_HANDLE;
  checkVk(vk.vkCreateDescriptorSetLayout(device.handle(), &setInfo, nullptr, &setLayout),
          "create the descriptor layout of {}", name_);
  setLayout_ = device.own(name_, setLayout, vk.vkDestroyDescriptorSetLayout);

  const VkPushConstantRange push{VK_SHADER_STAGE_COMPUTE_BIT, 0, kMaxPushBytes};
  auto layoutInfo = vkStruct<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
  layoutInfo.setLayoutCount = 1;
  layoutInfo.pSetLayouts = &setLayout;
  layoutInfo.pushConstantRangeCount = interface_.pushConstants ? 1 : 0;
  layoutInfo.pPushConstantRanges = &push;
  VkPipelineLayout layout = VK_NULL_HANDLE;
  checkVk(vk.vkCreatePipelineLayout(device.handle(), &layoutInfo, nullptr, &layout),
          "create the pipeline layout of {}", name_);
  layout_ = device.own(name_, layout, vk.vkDestroyPipelineLayout);
}

void ComputePipeline::createPipeline(GpuDevice& device, std::span<const std::uint32_t> spirv,
                                     std::span<const Specialization> constants) {
  const VolkDeviceTable& vk = device.vk();
  auto moduleInfo = vkStruct<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
  moduleInfo.codeSize = spirv.size_bytes();
  moduleInfo.pCode = spirv.data();
  VkShaderModule shader = VK_NULL_HANDLE;
  checkVk(vk.vkCreateShaderModule(device.handle(), &moduleInfo, nullptr, &shader), "load shader {}", name_);
  const Owned<VkShaderModule> ownedShader = device.own(name_, shader, vk.vkDestroyShaderModule);

  std::vector<VkSpecializationMapEntry> entries;
  for (std::size_t i = 0; i < constants.size(); ++i)
    entries.push_back(
        {constants[i].id,
         static_cast<std::uint32_t>(i * sizeof(Specialization) + offsetof(Specialization, value)),
         sizeof(Specialization::value)});
  const VkSpecializationInfo specialization{static_cast<std::uint32_t>(entries.size()), entries.data(),
                                            constants.size_bytes(), constants.data()};
  auto info = vkStruct<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
  info.stage = vkStruct<VkPipelineShaderStageCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO);
  info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
  info.stage.module = shader;
  info.stage.pName = "main";
  info.stage.pSpecializationInfo = &specialization;
  info.layout = layout_.get();
  VkPipeline pipeline = VK_NULL_HANDLE;
  checkVk(vk.vkCreateComputePipelines(device.handle(), VK_NULL_HANDLE, 1, &info, nullptr, &pipeline),
          "create pipeline {}", name_);
  pipeline_ = device.own(name_, pipeline, vk.vkDestroyPipeline);
}

}  // namespace isophote
