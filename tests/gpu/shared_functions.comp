// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_scalar_block_layout : require
#include "gpu/shared_functions.shared.h"

layout(local_size_x = 64) in;
layout(constant_id = kSpecKernel) const uint kernel = kKernelConstant;
layout(push_constant, scalar) uniform PushConstants { SharedFunctionsPush push; };
layout(binding = kBindMaterials, scalar) readonly buffer Materials { Material materials[]; };
layout(binding = kBindPhotons, scalar) readonly buffer Photons { Photon photons[]; };
layout(binding = kBindResults, scalar) writeonly buffer Results { SharedFunctionsResult results[]; };

void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= push.count) return;
  results[i] = sharedFunctions(materials[i], photons[i], push.camera, push.seed, i, kernel);
}
