// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/instance.h"

#include <algorithm>
#include <cstring>

namespace isophote {

namespace {
constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

/// Opens libvulkan once per process; volk's pointers to the loader's entry points are never written again.
void openLoader() {
  static const VkResult result = volkInitialize();
  if (result != VK_SUCCESS) fail(ErrorKind::kDevice, "", "no Vulkan loader (libvulkan.so.1) is installed");
}

/// Calls an enumerating function of the API until it has written every element.
template <class T, class Enumerate>
std::vector<T> enumerated(std::string_view what, Enumerate enumerate) {
  std::vector<T> elements;
  VkResult result = VK_INCOMPLETE;
  while (result == VK_INCOMPLETE) {
    std::uint32_t count = 0;
    checkVk(enumerate(&count, static_cast<T*>(nullptr)), "list {}", what);
    elements.assign(count, T{});
    result = count > 0 ? enumerate(&count, elements.data()) : VK_SUCCESS;
    elements.resize(count);
  }
  checkVk(result, "list {}", what);
  return elements;
}

std::vector<VkExtensionProperties> instanceExtensions(const char* layer) {
  return enumerated<VkExtensionProperties>("instance extensions", [&](auto* count, auto* elements) {
    return vkEnumerateInstanceExtensionProperties(layer, count, elements);
  });
}

bool offers(const std::vector<VkExtensionProperties>& extensions, std::string_view name) {
  return std::ranges::any_of(extensions, [&](const auto& e) { return name == e.extensionName; });
}

void requireValidationLayer() {
  const auto layers = enumerated<VkLayerProperties>("layers", [](auto* count, auto* elements) {
    return vkEnumerateInstanceLayerProperties(count, elements);
  });
  if (std::ranges::none_of(layers, [](const auto& l) { return !std::strcmp(l.layerName, kValidationLayer); }))
    fail(ErrorKind::kDevice, "", "{} is not installed (Debian: vulkan-validationlayers)", kValidationLayer);
}

VKAPI_ATTR VkBool32 VKAPI_CALL collect(VkDebugUtilsMessageSeverityFlagBitsEXT,
                                       VkDebugUtilsMessageTypeFlagsEXT,
                                       const VkDebugUtilsMessengerCallbackDataEXT* data, void* log) {
  static_cast<ValidationLog*>(log)->add(data->pMessage);
  return VK_FALSE;
}

VkDebugUtilsMessengerCreateInfoEXT messengerInfo(ValidationLog& log) {
  auto messenger =
      vkStruct<VkDebugUtilsMessengerCreateInfoEXT>(VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT);
  messenger.messageSeverity =
      VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
  messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
  messenger.pfnUserCallback = collect;
  messenger.pUserData = &log;
  return messenger;
}

DeviceType typeOf(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return DeviceType::kDiscrete;
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return DeviceType::kIntegrated;
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return DeviceType::kVirtual;
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return DeviceType::kSoftware;
    default:
      return DeviceType::kOther;
  }
}

std::uint64_t largestDeviceHeap(const VkPhysicalDeviceMemoryProperties& memory) {
  std::uint64_t largest = 0;
  for (const VkMemoryHeap& heap : std::span(memory.memoryHeaps, memory.memoryHeapCount))
    if (heap.flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) largest = std::max(largest, heap.size);
  return largest;
}

/// The first family with compute and graphics, else the first with compute.
std::optional<std::uint32_t> computeFamily(const std::vector<VkQueueFamilyProperties>& families) {
  for (const VkQueueFlags wanted : {VK_QUEUE_COMPUTE_BIT | VK_QUEUE_GRAPHICS_BIT, VK_QUEUE_COMPUTE_BIT + 0})
    for (std::uint32_t i = 0; i < families.size(); ++i)
      if ((families[i].queueFlags & wanted) == wanted) return i;
  return std::nullopt;
}
}  // namespace

void ValidationLog::add(std::string message) {
  const std::scoped_lock lock(mutex_);
  messages_.push_back(std::move(message));
}

std::vector<std::string> ValidationLog::messages() const {
  const std::scoped_lock lock(mutex_);
  return messages_;
}

VulkanInstance::VulkanInstance(bool validation) {
  openLoader();
  if (validation) requireValidationLayer();
  create(validation);
  // A constructor that throws runs no destructor.
  try {
    if (validation) listen();
    findDevices();
  } catch (...) {
    destroy();
    throw;
  }
}

VulkanInstance::~VulkanInstance() { destroy(); }

void VulkanInstance::destroy() {
  if (messenger_ != VK_NULL_HANDLE) functions_.destroyDebugUtilsMessenger(handle_, messenger_, nullptr);
  functions_.destroyInstance(handle_, nullptr);
}

void VulkanInstance::listen() {
  const VkDebugUtilsMessengerCreateInfoEXT info = messengerInfo(*log_);
  checkVk(functions_.createDebugUtilsMessenger(handle_, &info, nullptr, &messenger_),
          "listen to the validation layers");
}

void VulkanInstance::create(bool validation) {
  std::vector<const char*> extensions;
  const bool debugUtils =
      validation || offers(instanceExtensions(nullptr), VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  if (debugUtils) extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);

  VkDebugUtilsMessengerCreateInfoEXT messenger = messengerInfo(*log_);
  const VkValidationFeatureEnableEXT synchronisation =
      VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT;
  auto features = vkStruct<VkValidationFeaturesEXT>(VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT);
  features.enabledValidationFeatureCount = 1;
  features.pEnabledValidationFeatures = &synchronisation;

  auto application = vkStruct<VkApplicationInfo>(VK_STRUCTURE_TYPE_APPLICATION_INFO);
  application.pApplicationName = "isophote";
  application.apiVersion = VK_API_VERSION_1_3;
  auto info = vkStruct<VkInstanceCreateInfo>(VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO);
  info.pApplicationInfo = &application;
  if (validation) {
    // The messenger in the chain also hears of the creation and destruction of the instance itself.
    messenger.pNext = &features;
    info.pNext = &messenger;
    info.enabledLayerCount = 1;
    info.ppEnabledLayerNames = &kValidationLayer;
    if (offers(instanceExtensions(kValidationLayer), VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME))
      extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
    else
      messenger.pNext = nullptr;
  }
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const VkResult result = vkCreateInstance(&info, nullptr, &handle_);
  if (result == VK_ERROR_INCOMPATIBLE_DRIVER)
    fail(ErrorKind::kDevice, "", "the Vulkan loader found no driver (Debian: mesa-vulkan-drivers)");
  checkVk(result, "create a Vulkan instance");

  loadFunctions(debugUtils);
}

void VulkanInstance::loadFunctions(bool debugUtils) {
  const auto load = [this]<class Function>(Function& function, const char* name) {
    function = reinterpret_cast<Function>(vkGetInstanceProcAddr(handle_, name));
  };
  load(functions_.destroyInstance, "vkDestroyInstance");
  load(functions_.enumeratePhysicalDevices, "vkEnumeratePhysicalDevices");
  load(functions_.getPhysicalDeviceProperties, "vkGetPhysicalDeviceProperties");
  load(functions_.getPhysicalDeviceProperties2, "vkGetPhysicalDeviceProperties2");
  load(functions_.getPhysicalDeviceFeatures2, "vkGetPhysicalDeviceFeatures2");
  load(functions_.getPhysicalDeviceMemoryProperties, "vkGetPhysicalDeviceMemoryProperties");
  load(functions_.getPhysicalDeviceQueueFamilyProperties, "vkGetPhysicalDeviceQueueFamilyProperties");
  load(functions_.enumerateDeviceExtensionProperties, "vkEnumerateDeviceExtensionProperties");
  load(functions_.createDevice, "vkCreateDevice");
  load(functions_.getDeviceProcAddr, "vkGetDeviceProcAddr");
  if (!debugUtils) return;
  load(functions_.createDebugUtilsMessenger, "vkCreateDebugUtilsMessengerEXT");
  load(functions_.destroyDebugUtilsMessenger, "vkDestroyDebugUtilsMessengerEXT");
  load(functions_.setDebugUtilsObjectName, "vkSetDebugUtilsObjectNameEXT");
  load(functions_.cmdBeginDebugUtilsLabel, "vkCmdBeginDebugUtilsLabelEXT");
  load(functions_.cmdEndDebugUtilsLabel, "vkCmdEndDebugUtilsLabelEXT");
}

void VulkanInstance::findDevices() {
  const auto handles = enumerated<VkPhysicalDevice>("Vulkan devices", [&](auto* count, auto* elements) {
    return functions_.enumeratePhysicalDevices(handle_, count, elements);
  });
  for (const VkPhysicalDevice handle : handles) devices_.push_back(inspect(handle));
}

PhysicalDevice VulkanInstance::inspect(VkPhysicalDevice handle) const {
  PhysicalDevice device;
  device.handle = handle;
  DeviceFacts& facts = device.facts;
  VkPhysicalDeviceProperties basic{};
  functions_.getPhysicalDeviceProperties(handle, &basic);
  facts.name = basic.deviceName;
  facts.type = typeOf(basic.deviceType);
  facts.version = {VK_API_VERSION_MAJOR(basic.apiVersion), VK_API_VERSION_MINOR(basic.apiVersion),
                   VK_API_VERSION_PATCH(basic.apiVersion)};
  // The structs below are not for older devices.
  if (basic.apiVersion < VK_API_VERSION_1_3) return device;

  auto driver =
      vkStruct<VkPhysicalDeviceVulkan12Properties>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_PROPERTIES);
  auto subgroups = vkStruct<VkPhysicalDeviceVulkan11Properties>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_1_PROPERTIES, &driver);
  auto properties =
      vkStruct<VkPhysicalDeviceProperties2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &subgroups);
  functions_.getPhysicalDeviceProperties2(handle, &properties);
  facts.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
  facts.subgroupSize = subgroups.subgroupSize;
  const VkPhysicalDeviceLimits& limits = properties.properties.limits;
  facts.maxWorkgroupInvocations = limits.maxComputeWorkGroupInvocations;
  facts.maxStorageBuffers = limits.maxPerStageDescriptorStorageBuffers;
  facts.maxStorageBufferBytes = limits.maxStorageBufferRange;
  facts.sharedMemoryBytes = limits.maxComputeSharedMemorySize;
  std::ranges::copy(limits.maxComputeWorkGroupCount, facts.maxGroups.begin());

  auto features13 =
      vkStruct<VkPhysicalDeviceVulkan13Features>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES);
  auto features12 = vkStruct<VkPhysicalDeviceVulkan12Features>(
      VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &features13);
  auto features =
      vkStruct<VkPhysicalDeviceFeatures2>(VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &features12);
  functions_.getPhysicalDeviceFeatures2(handle, &features);
  facts.scalarBlockLayout = features12.scalarBlockLayout;
  facts.synchronization2 = features13.synchronization2;
  facts.maintenance4 = features13.maintenance4;

  VkPhysicalDeviceMemoryProperties memory{};
  functions_.getPhysicalDeviceMemoryProperties(handle, &memory);
  facts.deviceMemoryBytes = largestDeviceHeap(memory);
  const auto extensions =
      enumerated<VkExtensionProperties>("device extensions", [&](auto* count, auto* elements) {
        return functions_.enumerateDeviceExtensionProperties(handle, nullptr, count, elements);
      });
  facts.hasRayQuery =
      facts.type != DeviceType::kSoftware && offers(extensions, VK_KHR_RAY_QUERY_EXTENSION_NAME);
  chooseQueue(device);
  return device;
}

void VulkanInstance::chooseQueue(PhysicalDevice& device) const {
  std::uint32_t count = 0;
  functions_.getPhysicalDeviceQueueFamilyProperties(device.handle, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  functions_.getPhysicalDeviceQueueFamilyProperties(device.handle, &count, families.data());
  const auto family = computeFamily(families);
  if (!family) return;
  const VkQueueFamilyProperties& chosen = families[*family];
  device.queueFamily = *family;
  device.facts.computeQueue = true;
  device.facts.graphicsQueue = chosen.queueFlags & VK_QUEUE_GRAPHICS_BIT;
  const std::uint32_t bits = chosen.timestampValidBits;
  device.timestampMask = bits == 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << bits) - 1;
  VkPhysicalDeviceProperties properties{};
  functions_.getPhysicalDeviceProperties(device.handle, &properties);
  device.facts.timestampNanoseconds = bits > 0 ? double(properties.limits.timestampPeriod) : 0.0;
}

}  // namespace isophote
