// Compute on a Vulkan device: a device, memory that both sides see, and programs that run over it.
// No formula of a stage lives here; shaders get theirs from src/kernel (glslc -I src).
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace pelage::vulkan {

struct DeviceOptions {
  std::string name;         ///< part of the wanted device's name; empty: the most capable kind
  bool validation = false;  ///< with the Khronos validation layer; throws Error where it is not installed
};

/// Names of the devices that can compute, as their drivers give them; empty where there is no driver.
std::vector<std::string> devices();

/// One device, one queue. Not thread-safe; movable. Must outlive what is made on it.
class Device {
 public:
  /// Throws Error where no device has that name, or none is there at all.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(Device&&) noexcept;
  Device& operator=(Device&&) noexcept;

  const std::string& name() const;
  std::size_t max_buffer_bytes() const;  ///< of one storage buffer binding
  /// What the validation layer found wrong so far, one entry a message; always empty without it.
  const std::vector<std::string>& complaints() const;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

/// A storage buffer in memory that the host has mapped; zeroed. Contents are coherent between calls of Program::run().
class StorageBuffer {
 public:
  /// `bytes` in 1…max_buffer_bytes(); throws Error otherwise, and where the device has no room.
  StorageBuffer(Device& device, std::size_t bytes);
  ~StorageBuffer();
  StorageBuffer(StorageBuffer&&) noexcept;
  StorageBuffer& operator=(StorageBuffer&&) noexcept;

  std::size_t size() const;  ///< bytes
  /// The whole buffer as elements of T; a remainder smaller than T is left out.
  template <class T>
  std::span<T> as() {
    return {static_cast<T*>(data()), size() / sizeof(T)};
  }

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  void* data();
  std::unique_ptr<Impl> impl_;
};

/// A compute shader, ready to run. Set 0 holds its storage buffers at bindings 0…buffer_count − 1.
class Program {
 public:
  /// `spirv` whole SPIR-V words with the entry point `main`; `push_bytes` of push constants, a multiple of 4, at most 128.
  Program(Device& device, std::span<const std::uint32_t> spirv, int buffer_count, std::size_t push_bytes = 0);
  ~Program();
  Program(Program&&) noexcept;
  Program& operator=(Program&&) noexcept;

  /// Runs `groups` work groups and waits for them. `buffers` has buffer_count entries, `push` push_bytes bytes.
  void run(std::uint32_t groups, std::span<StorageBuffer* const> buffers, std::span<const std::byte> push = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pelage::vulkan
