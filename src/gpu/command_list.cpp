// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/command_list.h"

#include <algorithm>
#include <limits>

namespace isophote {

namespace {
constexpr std::uint32_t kMaxScopes = 128;
constexpr std::uint32_t kSetsPerPool = 32;
constexpr std::uint32_t kBuffersPerPool = 8 * kSetsPerPool;

void memoryBarrier(const GpuDevice& device, VkCommandBuffer commands, const VkMemoryBarrier2& barrier) {
  auto dependency = vkStruct<VkDependencyInfo>(VK_STRUCTURE_TYPE_DEPENDENCY_INFO);
  dependency.memoryBarrierCount = 1;
  dependency.pMemoryBarriers = &barrier;
  device.vk().vkCmdPipelineBarrier2(commands, &dependency);
}
}  // namespace

CommandList::CommandList(GpuDevice& device, std::string name) : device_(device), name_(std::move(name)) {
  const VolkDeviceTable& vk = device_.vk();
  // A pool per list: pools must not be shared by threads, and freeing the pool frees everything recorded.
  auto poolInfo = vkStruct<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
  poolInfo.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  poolInfo.queueFamilyIndex = device_.queueFamily();
  VkCommandPool pool = VK_NULL_HANDLE;
  checkVk(vk.vkCreateCommandPool(device_.handle(), &poolInfo, nullptr, &pool),
          "create the command pool of {}", name_);
  commandPool_ = device_.own(name_, pool, vk.vkDestroyCommandPool);

  auto info = vkStruct<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
  info.commandPool = pool;
  info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  info.commandBufferCount = 1;
  checkVk(vk.vkAllocateCommandBuffers(device_.handle(), &info, &commands_), "allocate commands for {}",
          name_);
  device_.setName(commands_, name_);
  auto begin = vkStruct<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
  begin.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  checkVk(vk.vkBeginCommandBuffer(commands_, &begin), "begin {}", name_);
  // What earlier lists wrote is available but not yet visible to this one.
  barrier();
}

CommandList::Scope::Scope(CommandList& list, std::string name)
    : list_(list), index_(static_cast<std::uint32_t>(list.scopes_.size())) {
  const GpuDevice& device = list_.device_;
  const VolkDeviceTable& vk = device.vk();
  if (index_ >= kMaxScopes)
    fail(ErrorKind::kInternal, list_.name_, "has more than {} timed scopes", kMaxScopes);
  if (!list_.queries_ && device.facts().timestampNanoseconds > 0) {
    auto info = vkStruct<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    info.queryType = VK_QUERY_TYPE_TIMESTAMP;
    info.queryCount = 2 * kMaxScopes;
    VkQueryPool pool = VK_NULL_HANDLE;
    checkVk(vk.vkCreateQueryPool(device.handle(), &info, nullptr, &pool), "create the timers of {}",
            list_.name_);
    list_.queries_ = device.own(list_.name_, pool, vk.vkDestroyQueryPool);
    vk.vkCmdResetQueryPool(list_.commands_, pool, 0, info.queryCount);
  }
  device.beginLabel(list_.commands_, name);
  if (list_.queries_)
    vk.vkCmdWriteTimestamp2(list_.commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT, list_.queries_.get(),
                            2 * index_);
  list_.scopes_.push_back(std::move(name));
}

CommandList::Scope::~Scope() {
  if (list_.queries_)
    list_.device_.vk().vkCmdWriteTimestamp2(list_.commands_, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                            list_.queries_.get(), 2 * index_ + 1);
  list_.device_.endLabel(list_.commands_);
}

void CommandList::use(const ComputePipeline& pipeline) {
  device_.vk().vkCmdBindPipeline(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline.handle());
  pipeline_ = &pipeline;
  bound_.clear();
  pushed_ = false;
}

void CommandList::pushBytes(const void* data, std::uint32_t bytes) {
  if (!pipeline_ || !pipeline_->shaderInterface().pushConstants)
    fail(ErrorKind::kInternal, name_, "pushes constants to a shader that has none");
  device_.vk().vkCmdPushConstants(commands_, pipeline_->layout(), VK_SHADER_STAGE_COMPUTE_BIT, 0, bytes,
                                  data);
  pushed_ = true;
}

void CommandList::dispatch(std::array<std::uint32_t, 3> groups) {
  if (!pipeline_) fail(ErrorKind::kInternal, name_, "dispatches without a pipeline");
  if (pipeline_->shaderInterface().pushConstants && !pushed_)
    fail(ErrorKind::kInternal, pipeline_->name(), "is dispatched without its push constants");
  const auto& most = device_.facts().maxGroups;
  if (groups[0] > most[0] || groups[1] > most[1] || groups[2] > most[2])
    fail(ErrorKind::kDevice, pipeline_->name(), "{} x {} x {} workgroups are more than {} runs at once",
         groups[0], groups[1], groups[2], device_.facts().name);
  bindDescriptors();
  device_.vk().vkCmdDispatch(commands_, groups[0], groups[1], groups[2]);
}

void CommandList::dispatchItems(std::uint64_t count) {
  const std::uint32_t size = pipeline_ ? pipeline_->shaderInterface().workgroupSize[0] : 0;
  if (size == 0) fail(ErrorKind::kInternal, name_, "needs a shader with a fixed workgroup size");
  // Too many groups saturate, and dispatch() refuses them.
  const std::uint64_t groups = (count + size - 1) / size;
  dispatch(
      {static_cast<std::uint32_t>(std::min<std::uint64_t>(groups, std::numeric_limits<std::uint32_t>::max())),
       1, 1});
}

void CommandList::bindDescriptors() {
  const auto& bindings = pipeline_->shaderInterface().bindings;
  if (bindings.empty()) return;
  const VkDescriptorSet set = newSet();
  std::vector<VkDescriptorBufferInfo> buffers;
  std::vector<VkWriteDescriptorSet> writes;
  buffers.reserve(bindings.size());  // The writes point into it.
  for (const SpirvBinding& binding : bindings) {
    const auto bound = bound_.find(binding.binding);
    if (bound == bound_.end())
      fail(ErrorKind::kInternal, pipeline_->name(), "is dispatched with nothing bound to {} ({})",
           binding.binding, binding.name);
    buffers.push_back({bound->second, 0, VK_WHOLE_SIZE});
    auto& write = writes.emplace_back(vkStruct<VkWriteDescriptorSet>(VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET));
    write.dstSet = set;
    write.dstBinding = binding.binding;
    write.descriptorCount = 1;
    write.descriptorType = VK_DESCRIPTOR_TYPE_STORAGE_BUFFER;
    write.pBufferInfo = &buffers.back();
  }
  const VolkDeviceTable& vk = device_.vk();
  vk.vkUpdateDescriptorSets(device_.handle(), static_cast<std::uint32_t>(writes.size()), writes.data(), 0,
                            nullptr);
  vk.vkCmdBindDescriptorSets(commands_, VK_PIPELINE_BIND_POINT_COMPUTE, pipeline_->layout(), 0, 1, &set, 0,
                             nullptr);
}

VkDescriptorSet CommandList::newSet() {
  if (descriptorPools_.empty()) addDescriptorPool();
  const VkDescriptorSetLayout layout = pipeline_->setLayout();
  auto info = vkStruct<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
  info.descriptorPool = descriptorPools_.back().get();
  info.descriptorSetCount = 1;
  info.pSetLayouts = &layout;
  VkDescriptorSet set = VK_NULL_HANDLE;
  const auto allocate = [&] { return device_.vk().vkAllocateDescriptorSets(device_.handle(), &info, &set); };
  VkResult result = allocate();
  if (result == VK_ERROR_OUT_OF_POOL_MEMORY || result == VK_ERROR_FRAGMENTED_POOL) {
    addDescriptorPool();
    info.descriptorPool = descriptorPools_.back().get();
    result = allocate();
  }
  checkVk(result, "allocate descriptors for {}", pipeline_->name());
  return set;
}

void CommandList::addDescriptorPool() {
  // Room for any one shader, however many buffers it has.
  const auto wanted = static_cast<std::uint32_t>(pipeline_->shaderInterface().bindings.size());
  const VkDescriptorPoolSize size{VK_DESCRIPTOR_TYPE_STORAGE_BUFFER, std::max(kBuffersPerPool, wanted)};
  auto info = vkStruct<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
  info.maxSets = kSetsPerPool;
  info.poolSizeCount = 1;
  info.pPoolSizes = &size;
  VkDescriptorPool pool = VK_NULL_HANDLE;
  checkVk(device_.vk().vkCreateDescriptorPool(device_.handle(), &info, nullptr, &pool),
          "create the descriptor pool of {}", name_);
  descriptorPools_.push_back(device_.own(name_, pool, device_.vk().vkDestroyDescriptorPool));
}

void CommandList::barrier() {
  auto all = vkStruct<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  all.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  all.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  all.dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  all.dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT;
  memoryBarrier(device_, commands_, all);
}

void CommandList::copy(const Buffer& from, std::uint64_t fromOffset, Buffer& to, std::uint64_t toOffset,
                       std::uint64_t bytes) {
  const VkBufferCopy region{fromOffset, toOffset, bytes};
  device_.vk().vkCmdCopyBuffer(commands_, from.handle(), to.handle(), 1, &region);
}

void CommandList::fill(Buffer& buffer, std::uint32_t word) {
  device_.vk().vkCmdFillBuffer(commands_, buffer.handle(), 0, VK_WHOLE_SIZE, word);
}

std::vector<ScopeTime> CommandList::submitAndWait() {
  const VolkDeviceTable& vk = device_.vk();
  auto toHost = vkStruct<VkMemoryBarrier2>(VK_STRUCTURE_TYPE_MEMORY_BARRIER_2);
  toHost.srcStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT;
  toHost.srcAccessMask = VK_ACCESS_2_MEMORY_WRITE_BIT;
  toHost.dstStageMask = VK_PIPELINE_STAGE_2_HOST_BIT;
  toHost.dstAccessMask = VK_ACCESS_2_HOST_READ_BIT;
  memoryBarrier(device_, commands_, toHost);
  checkVk(vk.vkEndCommandBuffer(commands_), "record {}", name_);

  const auto info = vkStruct<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
  VkFence fence = VK_NULL_HANDLE;
  checkVk(vk.vkCreateFence(device_.handle(), &info, nullptr, &fence), "create the fence of {}", name_);
  const Owned<VkFence> owned = device_.own(name_, fence, vk.vkDestroyFence);
  device_.submitAndWait(commands_, fence, name_);
  return readTimes();
}

std::vector<ScopeTime> CommandList::readTimes() const {
  std::vector<ScopeTime> times;
  for (std::uint32_t i = 0; i < scopes_.size(); ++i) {
    ScopeTime& time = times.emplace_back(ScopeTime{scopes_[i]});
    if (!queries_) continue;
    std::array<std::uint64_t, 2> ticks{};
    checkVk(device_.vk().vkGetQueryPoolResults(device_.handle(), queries_.get(), 2 * i, 2, sizeof(ticks),
                                               ticks.data(), sizeof(ticks[0]),
                                               VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
            "read the timers of {}", name_);
    // The mask also makes the difference right when the counter wrapped in between.
    time.milliseconds =
        double((ticks[1] - ticks[0]) & device_.timestampMask()) * device_.facts().timestampNanoseconds * 1e-6;
  }
  return times;
}

}  // namespace isophote
