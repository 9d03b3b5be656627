// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gpu/spirv_layout.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

namespace isophote {

/// The struct lies in the shader's buffers and push constants as it does in C++: the same members at the same
/// offsets and, where there are arrays of it, the same size.
///
///   expectSameOffsets(shaders::gather, "Photon", sizeof(Photon), {{"position", offsetof(Photon, position)},
///   ...});
inline void expectSameOffsets(std::span<const std::uint32_t> shaderWords, std::string_view structName,
                              std::size_t size, const std::map<std::string, std::uint32_t>& offsets) {
  bool found = false;
  for (const SpirvStruct& layout : readSpirv(structName, shaderWords).structs) {
    if (layout.name != structName) continue;
    found = true;
    EXPECT_EQ(layout.offsets, offsets) << structName;
    if (layout.arrayStride != 0) {
      EXPECT_EQ(layout.arrayStride, size) << structName;
    }
  }
  EXPECT_TRUE(found) << "the shader keeps no " << structName << " in a buffer";
}

}  // namespace isophote
