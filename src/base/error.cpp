// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"

#include "base/one_line.h"

namespace isophote {

namespace {

/// A name out of a file may be as long as the file. What matters stands at the ends.
constexpr std::size_t kMostBytes = 1200, kHeadBytes = 800, kTailBytes = 300;

std::string shortened(std::string text) {
  if (text.size() <= kMostBytes) return text;
  return text.substr(0, kHeadBytes) + " ... " + text.substr(text.size() - kTailBytes);
}

std::string joined(std::string_view subject, std::string_view sentence) {
  return shortened(
      onOneLine(subject.empty() ? std::string(sentence) : fmt::format("{}: {}", subject, sentence)));
}

}  // namespace

Error::Error(ErrorKind kind, std::string subject, std::string_view sentence)
    : std::runtime_error(joined(subject, sentence)), kind_(kind), subject_(std::move(subject)) {}

}  // namespace isophote
