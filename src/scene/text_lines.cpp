// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "scene/text_lines.h"

#include "base/number.h"

#include <cmath>
#include <cstring>

namespace isophote {

namespace {
// A backslash with a line break behind it is a blank: it joins two lines.
bool isBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\v' || c == '\f'; }
}  // namespace

std::optional<float> parseNumber(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const std::optional<double> value = finiteNumber(word);
  if (!value || !std::isfinite(float(*value))) return std::nullopt;
  return float(*value);
}

TextLines::TextLines(std::string subject, std::string_view text) : subject_(std::move(subject)) {
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  cursor_ = lineEnd_ = nextLine_ = text.data();
  end_ = text.data() + text.size();
}

bool TextLines::next() {
  while (nextLine_ < end_) {
    line_ = nextLineNumber_;
    cursor_ = nextLine_;
    const char* from = cursor_;
    for (;;) {
      const auto* found = static_cast<const char*>(std::memchr(from, '\n', std::size_t(end_ - from)));
      lineEnd_ = found ? found : end_;
      nextLine_ = found ? found + 1 : end_;
      ++nextLineNumber_;
      const char* last = lineEnd_ > cursor_ && lineEnd_[-1] == '\r' ? lineEnd_ - 1 : lineEnd_;
      if (!found || last == cursor_ || last[-1] != '\\') break;
      from = nextLine_;
    }
    skipBlanks();
    if (cursor_ < lineEnd_) return true;
  }
  cursor_ = lineEnd_ = end_;
  return false;
}

void TextLines::skipBlanks() {
  while (cursor_ < lineEnd_) {
    const bool joins =
        *cursor_ == '\\' && cursor_ + 1 < lineEnd_ && (cursor_[1] == '\n' || cursor_[1] == '\r');
    if (!isBlank(*cursor_) && !joins) break;
    ++cursor_;
  }
  if (cursor_ < lineEnd_ && *cursor_ == '#') cursor_ = lineEnd_;
}

std::string_view TextLines::word() {
  skipBlanks();
  const char* begin = cursor_;
  while (cursor_ < lineEnd_ && !isBlank(*cursor_)) ++cursor_;
  const char* end = cursor_;
  // The backslash of a joined line may touch the word before it.
  if (cursor_ < lineEnd_ && end > begin && end[-1] == '\\' && (*cursor_ == '\n' || *cursor_ == '\r')) --end;
  return {begin, std::size_t(end - begin)};
}

std::string_view TextLines::rest() {
  skipBlanks();
  const char* begin = cursor_;
  const char* end = begin;
  while (cursor_ < lineEnd_) {
    while (cursor_ < lineEnd_ && !isBlank(*cursor_)) ++cursor_;
    end = cursor_;
    skipBlanks();
  }
  return {begin, std::size_t(end - begin)};
}

std::optional<float> TextLines::optionalNumber(std::string_view what) {
  const std::string_view text = word();
  if (text.empty()) return std::nullopt;
  const std::optional<float> value = parseNumber(text);
  if (!value) fail("{} must be a finite number, not \"{}\"", what, text.substr(0, 40));
  return value;
}

float TextLines::number(std::string_view what) {
  const std::optional<float> value = optionalNumber(what);
  if (!value) fail("{} is missing at the end of the line", what);
  return *value;
}

}  // namespace isophote
