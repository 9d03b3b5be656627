// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace isophote {

/// Fewest single letters to insert, delete, replace or swap with their neighbour to turn one word into the
/// other; upper and lower case and '-' and '_' count as equal.
std::size_t editDistance(std::string_view a, std::string_view b);

/// ` (did you mean "radius"?)` for the candidate nearest to a mistyped word, or "" where none is near enough.
std::string suggestion(std::string_view word, std::span<const std::string_view> candidates);
std::string suggestion(std::string_view word, std::span<const std::string> candidates);

}  // namespace isophote
