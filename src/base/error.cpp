// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

namespace isophote {

namespace {
std::string joined(std::string_view subject, std::string_view sentence) {
  return subject.empty() ? std::string(sentence) : fmt::format("{}: {}", subject, sentence);
}
}  // namespace

Error::Error(ErrorKind kind, std::string subject, std::string_view sentence)
    : std::runtime_error(joined(subject, sentence)), kind_(kind), subject_(std::move(subject)) {}

}  // namespace isophote
