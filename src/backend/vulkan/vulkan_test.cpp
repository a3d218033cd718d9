// The device layer: buffers reach the shader and come back, and what cannot work says why.
#include "backend/vulkan/vulkan.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <pelage/error.h>

#include <array>

namespace pelage::vulkan {
namespace {

constexpr std::uint32_t kDouble[] = {
#include "double.comp.inc"
};

class Vulkan : public testing::Test {
 protected:
  void SetUp() override {
    if (devices().empty()) GTEST_SKIP() << "no Vulkan device is here; on Debian mesa-vulkan-drivers has one in software";
  }
};

TEST_F(Vulkan, ProgramReadsAndWritesBuffers) {
  Device device({.name = "", .validation = true});
  StorageBuffer inputs(device, 257 * sizeof(float)), results(device, 257 * sizeof(float));
  for (int i = 0; i < 257; ++i) inputs.as<float>()[i] = static_cast<float>(i);
  Program program(device, kDouble, 2, sizeof(float));
  const std::array buffers{&inputs, &results};
  for (const float offset : {0.5f, -3.0f}) {
    program.run(5, buffers, std::as_bytes(std::span(&offset, 1)));
    for (int i = 0; i < 257; ++i) ASSERT_EQ(results.as<float>()[i], 2.0f * static_cast<float>(i) + offset);
  }
  EXPECT_THAT(device.complaints(), testing::IsEmpty());
}

TEST_F(Vulkan, NothingRunsForNoGroups) {
  Device device;
  StorageBuffer buffer(device, 4), other(device, 4);
  Program program(device, kDouble, 2, sizeof(float));
  const std::array buffers{&buffer, &other};
  const float offset = 1;
  program.run(0, buffers, std::as_bytes(std::span(&offset, 1)));
  EXPECT_EQ(other.as<float>()[0], 0);
}

TEST_F(Vulkan, ThingsMove) {
  Device first;
  StorageBuffer buffer(first, 64);
  StorageBuffer taken = std::move(buffer);
  EXPECT_EQ(taken.size(), 64u);
  EXPECT_EQ(taken.as<float>().size(), 16u);
}

TEST_F(Vulkan, UnknownDeviceNamesThoseThatAreThere) {
  try {
    Device device({.name = "no such device"});
    FAIL() << "it was made";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("no such device"));
    EXPECT_THAT(error.remedy(), testing::HasSubstr(devices().front()));
  }
}

TEST_F(Vulkan, BufferSizeIsChecked) {
  Device device;
  EXPECT_THROW(StorageBuffer(device, 0), Error);
  EXPECT_THROW(StorageBuffer(device, device.max_buffer_bytes() + 1), Error);
}

}  // namespace
}  // namespace pelage::vulkan
