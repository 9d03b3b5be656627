// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"

#include <string_view>

namespace isophote {

/// Throws Error(kind) that names `subject`, the place and the key where an object of the JSON text has a key
/// twice: a parser would silently take one of the two. The text must be valid JSON.
void requireUniqueKeys(std::string_view text, std::string_view subject,
                       ErrorKind kind = ErrorKind::kBadInput);

}  // namespace isophote
