// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene.h"

namespace isophote {

/// Total power, mean of RGB [W]; see Light::power. Mesh lights and environments with a map carry theirs
/// already.
float lightPower(const Light& light, const Bounds& bounds);

}  // namespace isophote
