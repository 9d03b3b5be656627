// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/device.h"

#include "gpu/command_list.h"
#include "support/gpu_test.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <thread>

namespace isophote {
namespace {

/// Sets an environment variable until it goes out of scope.
class ScopedVariable {
 public:
  ScopedVariable(const char* name, const char* value) : name_(name) {
    if (const char* old = std::getenv(name)) old_ = old;
    setenv(name, value, 1);
  }
  ScopedVariable(const ScopedVariable&) = delete;
  ScopedVariable& operator=(const ScopedVariable&) = delete;
  ~ScopedVariable() {
    if (old_)
      setenv(name_, old_->c_str(), 1);
    else
      unsetenv(name_);
  }

 private:
  const char* name_;
  std::optional<std::string> old_;
};

TEST(ListDevices, SaysWhyThereIsNone) {
  // The loader reads one or the other, depending on its age.
  const ScopedVariable newer("VK_DRIVER_FILES", "/nonexistent.json");
  const ScopedVariable older("VK_ICD_FILENAMES", "/nonexistent.json");
  std::string whyNone;
  EXPECT_TRUE(listDevices(whyNone).empty());
  EXPECT_NE(whyNone.find("Vulkan loader"), std::string::npos) << whyNone;
  EXPECT_THROW(GpuDevice(), Error);
}

TEST(CheckVk, ThrowsWithWhatFailed) {
  EXPECT_NO_THROW(checkVk(VK_SUCCESS, "do {}", "this"));
  try {
    checkVk(VK_ERROR_DEVICE_LOST, "submit {}", "photon_trace");
    FAIL() << "did not throw";
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDevice);
    EXPECT_STREQ(error.what(), "cannot submit photon_trace: VK_ERROR_DEVICE_LOST");
  }
}

class GpuDeviceTest : public GpuTest {};

TEST_F(GpuDeviceTest, IsAmongTheListedOnes) {
  std::string whyNone;
  const std::vector<DeviceFacts> devices = listDevices(whyNone);
  EXPECT_TRUE(whyNone.empty()) << whyNone;
  EXPECT_TRUE(std::ranges::any_of(devices, [&](const auto& d) { return d.name == device().facts().name; }));
  EXPECT_TRUE(whyUnusable(device().facts()).empty());
}

TEST_F(GpuDeviceTest, RefusesWithTheReason) {
  DeviceOptions options;
  options.preferredName = "no such card";
  try {
    const GpuDevice other(options);
    FAIL() << "opened " << other.facts().name;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kDevice);
    EXPECT_NE(std::string(error.what()).find("is not the \"no such card\" asked for"), std::string::npos);
  }
}

TEST_F(GpuDeviceTest, SeveralLiveSideBySide) {
  std::vector<std::uint32_t> numbers(10000);
  std::iota(numbers.begin(), numbers.end(), 0u);
  const auto roundTrip = [&](GpuDevice& on) {
    for (int i = 0; i < 4; ++i)
      EXPECT_EQ(GpuArray<std::uint32_t>(on, "device_test.numbers", numbers).download(), numbers);
  };
  {
    std::vector<std::jthread> threads;
    for (int i = 0; i < 2; ++i) threads.emplace_back([&] { roundTrip(device()); });
    threads.emplace_back([&] {
      DeviceOptions options;
      options.allowSoftware = true;
      GpuDevice own(options);
      roundTrip(own);
    });
  }
}

TEST_F(GpuDeviceTest, HearsTheValidationLayers) {
  Buffer from(device(), "device_test.from", 16);
  Buffer to(device(), "device_test.to", 16);
  // Recorded, not run: the copy would write outside of `to`.
  CommandList list(device(), "device_test.too_far");
  list.copy(from, 0, to, 8, 16);
  expectValidationMessage("device_test.to");
}

}  // namespace
}  // namespace isophote
