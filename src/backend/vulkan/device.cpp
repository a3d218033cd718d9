// Instance, device choice, queue.
#include <algorithm>
#include <cstring>
#include <optional>

#include "backend/vulkan/impl.h"

namespace pelage::vulkan {
namespace {

constexpr const char* kValidationLayer = "VK_LAYER_KHRONOS_validation";

VKAPI_ATTR VkBool32 VKAPI_CALL remember(VkDebugUtilsMessageSeverityFlagBitsEXT, VkDebugUtilsMessageTypeFlagsEXT,
                                        const VkDebugUtilsMessengerCallbackDataEXT* data, void* complaints) {
  static_cast<std::vector<std::string>*>(complaints)->emplace_back(data->pMessage);
  return VK_FALSE;
}

vk::DebugUtilsMessengerCreateInfoEXT messenger_info(std::vector<std::string>* complaints) {
  using Severity = vk::DebugUtilsMessageSeverityFlagBitsEXT;
  using Type = vk::DebugUtilsMessageTypeFlagBitsEXT;
  return {{}, Severity::eWarning | Severity::eError, Type::eValidation | Type::ePerformance, remember, complaints};
}

vk::raii::Instance make_instance(const vk::raii::Context& context, bool validation, std::vector<std::string>* complaints) {
  const vk::ApplicationInfo application("pelage", 1, "pelage", 1, VK_API_VERSION_1_1);
  std::vector<const char*> layers, extensions;
  if (validation) {
    const auto installed = context.enumerateInstanceLayerProperties();
    if (std::none_of(installed.begin(), installed.end(),
                     [](const auto& layer) { return std::strcmp(layer.layerName, kValidationLayer) == 0; }))
      throw Error("vulkan", kValidationLayer, "the validation layer is not installed",
                  "install it, on Debian vulkan-validationlayers, or do without validation");
    layers.push_back(kValidationLayer);
    extensions.push_back(VK_EXT_DEBUG_UTILS_EXTENSION_NAME);
  }
  vk::InstanceCreateInfo info({}, &application, layers, extensions);
  const auto messenger = messenger_info(complaints);
  if (validation) info.pNext = &messenger;
  return {context, info};
}

std::optional<std::uint32_t> compute_family(const vk::raii::PhysicalDevice& device) {
  const auto families = device.getQueueFamilyProperties();
  for (std::uint32_t i = 0; i < families.size(); ++i)
    if (families[i].queueFlags & vk::QueueFlagBits::eCompute) return i;
  return std::nullopt;
}

/// Lower is better; the kinds in the order of what one expects of them.
int rank(const vk::raii::PhysicalDevice& device) {
  switch (device.getProperties().deviceType) {
    case vk::PhysicalDeviceType::eDiscreteGpu: return 0;
    case vk::PhysicalDeviceType::eIntegratedGpu: return 1;
    case vk::PhysicalDeviceType::eVirtualGpu: return 2;
    case vk::PhysicalDeviceType::eCpu: return 3;
    default: return 4;
  }
}

std::string name_of(const vk::raii::PhysicalDevice& device) { return device.getProperties().deviceName.data(); }

/// Every device that can compute, best first.
std::vector<vk::raii::PhysicalDevice> candidates(const vk::raii::Instance& instance) {
  std::vector<vk::raii::PhysicalDevice> found;
  for (auto& device : vk::raii::PhysicalDevices(instance))
    if (compute_family(device)) found.push_back(std::move(device));
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return found;
}

vk::raii::PhysicalDevice choose(const vk::raii::Instance& instance, const std::string& name) {
  std::string list;
  for (auto& device : candidates(instance)) {
    if (name_of(device).find(name) != std::string::npos) return std::move(device);
    list += (list.empty() ? "" : ", ") + name_of(device);
  }
  throw Error("vulkan", name, list.empty() ? "no device can compute" : "no device has that name",
              list.empty() ? "install a driver, on Debian mesa-vulkan-drivers" : "there are: " + list);
}

}  // namespace

std::vector<std::string> devices() {
  std::vector<std::string> names;
  try {
    const vk::raii::Context context;
    const vk::raii::Instance instance = make_instance(context, false, nullptr);
    for (const auto& device : candidates(instance)) names.push_back(name_of(device));
  } catch (const vk::SystemError&) {
    names.clear();  // no loader or no driver: nobody there
  }
  return names;
}

Device::Device(const DeviceOptions& options) : impl_(translated("no loader", [] { return std::make_unique<Impl>(); })) {
  Impl& s = *impl_;
  translated("making the instance", [&] {
    s.instance = make_instance(s.context, options.validation, &s.complaints);
    if (options.validation) s.messenger = vk::raii::DebugUtilsMessengerEXT(s.instance, messenger_info(&s.complaints));
  });
  translated("choosing a device", [&] { s.physical = choose(s.instance, options.name); });
  s.name = name_of(s.physical);
  s.max_buffer_bytes = s.physical.getProperties().limits.maxStorageBufferRange;
  s.queue_family = *compute_family(s.physical);
  translated(s.name, [&] {
    const float priority = 1;
    const vk::DeviceQueueCreateInfo queue({}, s.queue_family, 1, &priority);
    s.device = vk::raii::Device(s.physical, vk::DeviceCreateInfo({}, queue));
    s.queue = s.device.getQueue(s.queue_family, 0);
    s.commands =
        vk::raii::CommandPool(s.device, vk::CommandPoolCreateInfo(vk::CommandPoolCreateFlagBits::eTransient, s.queue_family));
  });
}

Device::~Device() = default;
Device::Device(Device&&) noexcept = default;
Device& Device::operator=(Device&&) noexcept = default;

const std::string& Device::name() const { return impl_->name; }
std::size_t Device::max_buffer_bytes() const { return impl_->max_buffer_bytes; }
const std::vector<std::string>& Device::complaints() const { return impl_->complaints; }

}  // namespace pelage::vulkan
