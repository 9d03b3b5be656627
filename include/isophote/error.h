// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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

}  // namespace isophote
