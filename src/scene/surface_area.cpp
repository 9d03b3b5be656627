// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/surface_area.h"

namespace isophote {

double surfaceArea(const Scene& scene) {
  double twice = 0;
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    for (const uvec3& t : mesh.triangles) {
      const vec3 origin = mesh.positions[t.x];
      const auto edge = [&](std::uint32_t v) {
        return vec3(instance.worldFromObject * vec4(mesh.positions[v] - origin, 0.0f));
      };
      twice += double(length(cross(edge(t.y), edge(t.z))));
    }
  }
  return 0.5 * twice;
}

}  // namespace isophote
