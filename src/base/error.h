// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace isophote {

enum class ErrorKind {
  kBadInput,   ///< A file's content or a scene; the program exits with 1.
  kBadUsage,   ///< An option, a setting or a combination of them; the program exits with 2.
  kDevice,     ///< A graphics device is missing or failed.
  kResources,  ///< Memory or disk space does not suffice.
  kStopped,    ///< The stop token was triggered.
  kInternal    ///< A bug.
};

/// The only exception that leaves the library: what() is one clear sentence that names the file or option
/// (`subject`) and says what would work.
class Error : public std::runtime_error {
 public:
  Error(ErrorKind kind, std::string subject, std::string_view sentence);
  ErrorKind kind() const { return kind_; }
  /// File or option that is at fault; may be empty.
  const std::string& subject() const { return subject_; }

 private:
  ErrorKind kind_;
  std::string subject_;
};

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
