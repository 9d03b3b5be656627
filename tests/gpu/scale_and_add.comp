// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_EXT_scalar_block_layout : require

// Multiplies every number by a constant of the pipeline and adds one: the order of two runs can be seen.
layout(local_size_x = 32) in;
layout(constant_id = 0) const uint factor = 1u;
layout(binding = 0, scalar) buffer Numbers { uint numbers[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i < numbers.length()) numbers[i] = numbers[i] * factor + 1u;
}
