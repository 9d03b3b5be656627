// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/device.h"

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

namespace isophote {

/// A test on a Vulkan device, software included, under the validation layers: any message of theirs fails it,
/// leaks found at the end too. Skips, with the reason, where there is no device or no layers.
class GpuTest : public ::testing::Test {
 protected:
  void SetUp() override {
    DeviceOptions options;
    options.validation = true;
    options.allowSoftware = true;
    try {
      device_ = std::make_unique<GpuDevice>(options);
    } catch (const Error& error) {
      GTEST_SKIP() << error.what();
    }
    log_ = device_->validationLog();
#ifdef __SANITIZE_ADDRESS__
    // With its last instance the loader unloads drivers and layers, and tests/lsan.supp could no longer name
    // them.
    static const auto* const keepLoaded = new VulkanInstance(true);
    ASSERT_NE(keepLoaded, nullptr);
#endif
  }

  void TearDown() override {
    if (!device_) return;
    device_.reset();
    const std::vector<std::string> messages = log_->messages();
    EXPECT_EQ(messages.size(), expectedMessages_) << fmt::format("{}", fmt::join(messages, "\n"));
  }

  /// For tests that do wrong on purpose: the layers must have said something with `part` in it, and nothing
  /// else.
  void expectValidationMessage(std::string_view part) {
    const std::vector<std::string> messages = log_->messages();
    for (const std::string& message : messages)
      EXPECT_NE(message.find(part), std::string::npos) << "unexpected: " << message;
    EXPECT_FALSE(messages.empty()) << "the validation layers did not object with " << part;
    expectedMessages_ = messages.size();
  }

  GpuDevice& device() { return *device_; }

 private:
  std::unique_ptr<GpuDevice> device_;
  std::shared_ptr<const ValidationLog> log_;
  std::size_t expectedMessages_ = 0;
};

}  // namespace isophote
