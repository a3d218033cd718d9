// What stands behind vulkan.h: handles that destroy themselves, and errors in the words of the house.
#pragma once

#include <pelage/error.h>

#include <string>
#include <utility>
#include <vector>
#include <vulkan/vulkan_raii.hpp>

#include "backend/vulkan/vulkan.h"

namespace pelage::vulkan {

struct Device::Impl {
  vk::raii::Context context;
  std::vector<std::string> complaints;  // written by the messenger, so it is destroyed after it
  vk::raii::Instance instance{nullptr};
  vk::raii::DebugUtilsMessengerEXT messenger{nullptr};
  vk::raii::PhysicalDevice physical{nullptr};
  vk::raii::Device device{nullptr};
  vk::raii::Queue queue{nullptr};
  vk::raii::CommandPool commands{nullptr};
  std::uint32_t queue_family = 0;
  std::string name;
  std::size_t max_buffer_bytes = 0;
};

struct StorageBuffer::Impl {
  vk::raii::DeviceMemory memory{nullptr};  // freed after the buffer that is bound to it
  vk::raii::Buffer buffer{nullptr};
  void* mapped = nullptr;
  std::size_t size = 0;
};

/// Runs `work`; what Vulkan throws from it becomes an Error that names `place`.
template <class Work>
auto translated(const std::string& place, Work&& work) {
  try {
    return std::forward<Work>(work)();
  } catch (const vk::SystemError& error) {
    throw Error("vulkan", place, error.what(), "");
  }
}

}  // namespace pelage::vulkan
