// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What a compiled shader says about its interface, read from the SPIR-V words themselves (glslc -g keeps the
// names).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote {

/// A struct as the shader lays it out in a buffer or in push constants.
struct SpirvStruct {
  std::string name;
  std::map<std::string, std::uint32_t> offsets;  ///< Bytes by member.
  std::uint32_t arrayStride = 0;                 ///< Where it is an array's element, else 0 [bytes].
};

enum class SpirvBindingKind { kStorageBuffer, kUniformBuffer, kOther };

/// A resource that the shader declares; `name` is the variable's, or its block's where it is anonymous.
struct SpirvBinding {
  std::uint32_t set = 0;
  std::uint32_t binding = 0;
  SpirvBindingKind kind = SpirvBindingKind::kOther;
  std::string name;
};

struct SpirvInterface {
  std::vector<SpirvStruct> structs;    ///< Those with offsets. One name may occur with several layouts.
  std::vector<SpirvBinding> bindings;  ///< In ascending order of binding.
  bool pushConstants = false;
  /// Invocations of a workgroup; {0, 0, 0} where specialization constants decide.
  std::array<std::uint32_t, 3> workgroupSize{};
};

/// Throws Error(kInternal) on words that are not a whole SPIR-V module. `name` is for the message.
SpirvInterface readSpirv(std::string_view name, std::span<const std::uint32_t> words);

}  // namespace isophote
