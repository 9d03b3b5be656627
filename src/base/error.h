// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "isophote/error.h"

#include <fmt/format.h>

namespace isophote {

/// Throws Error(kind, subject, formatted sentence). `what()` is "subject: sentence", or the sentence alone
/// where the subject is empty.
template <class... Args>
[[noreturn]] void fail(ErrorKind kind, std::string_view subject, fmt::format_string<Args...> sentence,
                       Args&&... args) {
  throw Error(kind, std::string(subject), fmt::format(sentence, std::forward<Args>(args)...));
}

template <class... Args>
[[noreturn]] void failInput(std::string_view subject, fmt::format_string<Args...> sentence, Args&&... args) {
  fail(ErrorKind::kBadInput, subject, sentence, std::forward<Args>(args)...);
}

template <class... Args>
[[noreturn]] void failUsage(std::string_view subject, fmt::format_string<Args...> sentence, Args&&... args) {
  fail(ErrorKind::kBadUsage, subject, sentence, std::forward<Args>(args)...);
}

}  // namespace isophote
