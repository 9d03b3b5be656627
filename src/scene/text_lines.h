// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"

#include <optional>
#include <string>
#include <string_view>

namespace isophote {

/// A finite decimal number that fills the whole word; nothing otherwise ("nan", "1e999" and "1,5" are no
/// numbers).
std::optional<float> parseNumber(std::string_view word);

/// Walks through the lines of a Wavefront file (.obj, .mtl) word by word and knows the line number for
/// errors. Takes LF and CRLF, a byte order mark, a comment after '#' at the start of a word, and lines joined
/// by a final '\'.
class TextLines {
 public:
  /// `subject` names the file in errors. The text must outlive this.
  TextLines(std::string subject, std::string_view text);

  /// Goes to the next line that is not empty; false at the end.
  bool next();
  /// Next word of the line; empty at its end.
  std::string_view word();
  /// What is left of the line, without blanks at either end.
  std::string_view rest();
  /// Next word as a number; `what` names it in the error.
  float number(std::string_view what);
  /// Next word as a number, or nothing at the line's end.
  std::optional<float> optionalNumber(std::string_view what);

  std::size_t line() const { return line_; }
  const std::string& subject() const { return subject_; }

  /// Throws Error(kBadInput): "file: line 12: sentence".
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> sentence, Args&&... args) const {
    failInput(subject_, "line {}: {}", line_, fmt::format(sentence, std::forward<Args>(args)...));
  }

 private:
  void skipBlanks();

  std::string subject_;
  const char* cursor_;   ///< Next unread character of the line.
  const char* lineEnd_;  ///< Without the line break.
  const char* nextLine_;
  const char* end_;
  std::size_t line_ = 0;
  std::size_t nextLineNumber_ = 1;
};

}  // namespace isophote
