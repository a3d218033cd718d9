// Buffers and programs.
#include <cstring>

#include "backend/vulkan/impl.h"
#include "core/check.h"

namespace pelage::vulkan {
namespace {

std::uint32_t mapped_memory_type(const vk::raii::PhysicalDevice& device, std::uint32_t allowed) {
  const auto wanted = vk::MemoryPropertyFlagBits::eHostVisible | vk::MemoryPropertyFlagBits::eHostCoherent;
  const vk::PhysicalDeviceMemoryProperties memory = device.getMemoryProperties();
  for (std::uint32_t i = 0; i < memory.memoryTypeCount; ++i)
    if ((allowed >> i & 1u) && (memory.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
  throw Error("vulkan", "storage buffer", "the device has no memory that the host can map", "");
}

}  // namespace

StorageBuffer::StorageBuffer(Device& device, std::size_t bytes) : impl_(std::make_unique<Impl>()) {
  Device::Impl& d = device.impl();
  const std::string place = "storage buffer of " + std::to_string(bytes) + " bytes";
  if (bytes == 0 || bytes > d.max_buffer_bytes)
    throw Error("vulkan", place, "the size is not in 1…" + std::to_string(d.max_buffer_bytes), "split the work");
  impl_->size = bytes;
  translated(place, [&] {
    impl_->buffer = vk::raii::Buffer(
        d.device, vk::BufferCreateInfo({}, bytes, vk::BufferUsageFlagBits::eStorageBuffer, vk::SharingMode::eExclusive));
    const vk::MemoryRequirements need = impl_->buffer.getMemoryRequirements();
    impl_->memory = vk::raii::DeviceMemory(
        d.device, vk::MemoryAllocateInfo(need.size, mapped_memory_type(d.physical, need.memoryTypeBits)));
    impl_->buffer.bindMemory(*impl_->memory, 0);
    impl_->mapped = impl_->memory.mapMemory(0, VK_WHOLE_SIZE);
    std::memset(impl_->mapped, 0, bytes);
  });
}

StorageBuffer::~StorageBuffer() = default;
StorageBuffer::StorageBuffer(StorageBuffer&&) noexcept = default;
StorageBuffer& StorageBuffer::operator=(StorageBuffer&&) noexcept = default;
std::size_t StorageBuffer::size() const { return impl_->size; }
void* StorageBuffer::data() { return impl_->mapped; }

struct Program::Impl {
  Device::Impl* device = nullptr;
  std::size_t buffer_count = 0, push_bytes = 0;
  vk::raii::DescriptorSetLayout set_layout{nullptr};
  vk::raii::PipelineLayout layout{nullptr};
  vk::raii::Pipeline pipeline{nullptr};
  vk::raii::DescriptorPool pool{nullptr};

  vk::raii::DescriptorSet bind(std::span<StorageBuffer* const> buffers) const;
};

Program::Program(Device& device, std::span<const std::uint32_t> spirv, int buffer_count, std::size_t push_bytes)
    : impl_(std::make_unique<Impl>()) {
  PELAGE_CHECK(buffer_count >= 1);
  PELAGE_CHECK(push_bytes % 4 == 0 && push_bytes <= 128);
  Impl& s = *impl_;
  s.device = &device.impl();
  s.buffer_count = static_cast<std::size_t>(buffer_count);
  s.push_bytes = push_bytes;
  const vk::raii::Device& d = s.device->device;
  translated("making a program", [&] {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (std::uint32_t i = 0; i < s.buffer_count; ++i)
      bindings.emplace_back(i, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
    s.set_layout = vk::raii::DescriptorSetLayout(d, vk::DescriptorSetLayoutCreateInfo({}, bindings));
    const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0, static_cast<std::uint32_t>(push_bytes));
    vk::PipelineLayoutCreateInfo layout({}, *s.set_layout);
    if (push_bytes > 0) layout.setPushConstantRanges(push);
    s.layout = vk::raii::PipelineLayout(d, layout);
    const vk::raii::ShaderModule module(d, vk::ShaderModuleCreateInfo({}, spirv.size_bytes(), spirv.data()));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main");
    s.pipeline = vk::raii::Pipeline(d, nullptr, vk::ComputePipelineCreateInfo({}, stage, *s.layout));
    const vk::DescriptorPoolSize room(vk::DescriptorType::eStorageBuffer, static_cast<std::uint32_t>(buffer_count));
    s.pool = vk::raii::DescriptorPool(
        d, vk::DescriptorPoolCreateInfo(vk::DescriptorPoolCreateFlagBits::eFreeDescriptorSet, 1, room));
  });
}

Program::~Program() = default;
Program::Program(Program&&) noexcept = default;
Program& Program::operator=(Program&&) noexcept = default;

vk::raii::DescriptorSet Program::Impl::bind(std::span<StorageBuffer* const> buffers) const {
  vk::raii::DescriptorSets sets(device->device, vk::DescriptorSetAllocateInfo(*pool, *set_layout));
  std::vector<vk::DescriptorBufferInfo> infos;
  for (const StorageBuffer* buffer : buffers) infos.emplace_back(*buffer->impl().buffer, 0, VK_WHOLE_SIZE);
  device->device.updateDescriptorSets(
      vk::WriteDescriptorSet(*sets.front(), 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos), nullptr);
  return std::move(sets.front());
}

void Program::run(std::uint32_t groups, std::span<StorageBuffer* const> buffers, std::span<const std::byte> push) {
  PELAGE_CHECK(buffers.size() == impl_->buffer_count);
  PELAGE_CHECK(push.size() == impl_->push_bytes);
  if (groups == 0) return;
  Device::Impl& d = *impl_->device;
  translated("running a program", [&] {
    const vk::raii::DescriptorSet set = impl_->bind(buffers);
    vk::raii::CommandBuffers made(d.device, vk::CommandBufferAllocateInfo(*d.commands, vk::CommandBufferLevel::ePrimary, 1));
    const vk::raii::CommandBuffer& commands = made.front();
    commands.begin(vk::CommandBufferBeginInfo(vk::CommandBufferUsageFlagBits::eOneTimeSubmit));
    commands.bindPipeline(vk::PipelineBindPoint::eCompute, *impl_->pipeline);
    commands.bindDescriptorSets(vk::PipelineBindPoint::eCompute, *impl_->layout, 0, *set, nullptr);
    if (!push.empty())
      commands.pushConstants<std::byte>(*impl_->layout, vk::ShaderStageFlagBits::eCompute, 0,
                                        {static_cast<std::uint32_t>(push.size()), push.data()});
    commands.dispatch(groups, 1, 1);
    const vk::MemoryBarrier to_host(vk::AccessFlagBits::eShaderWrite, vk::AccessFlagBits::eHostRead);
    commands.pipelineBarrier(vk::PipelineStageFlagBits::eComputeShader, vk::PipelineStageFlagBits::eHost, {}, to_host, nullptr,
                             nullptr);
    commands.end();
    const vk::raii::Fence done(d.device, vk::FenceCreateInfo());
    d.queue.submit(vk::SubmitInfo({}, {}, *commands), *done);
    if (d.device.waitForFences(*done, VK_TRUE, UINT64_MAX) != vk::Result::eSuccess)
      throw Error("vulkan", d.name, "the device did not finish", "");
  });
}

}  // namespace pelage::vulkan
