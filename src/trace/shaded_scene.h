// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// What a TraceScene keeps of a scene for shading, made when it is built.
#pragma once

#include "trace/trace_scene.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace isophote {

/// Fills `triangles` with those of every mesh that is placed (uses[mesh] > 0); returns where each mesh
/// begins. Throws Error(kResources) where they do not fit the budget.
std::vector<std::size_t> gatherTriangles(const Scene& scene, const std::vector<std::uint32_t>& uses,
                                         std::uint64_t budgetBytes, LargeVector<ShadedTriangle>& triangles);

ShadedMaterial shadedMaterial(const Scene& scene, const Material& m);

/// True where a solid of that material absorbs light inside it.
bool absorbsInside(const Material& m);

/// `triangles` are those of its mesh, `materials` those of the scene.
ShadedInstance shadedInstance(const Scene& scene, const Instance& instance, const ShadedTriangle* triangles,
                              const ShadedMaterial* materials);

/// Moves the `count` triangles of an instance that has its mesh to itself.
void moveToWorld(ShadedInstance& instance, std::size_t count, LargeVector<ShadedTriangle>& triangles);

}  // namespace isophote
