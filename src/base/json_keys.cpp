// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/json_keys.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

namespace isophote {

namespace {

using Json = nlohmann::json;

/// Is told of everything in the text and remembers the keys of the objects that are open.
class KeyWatch : public nlohmann::json_sax<Json> {
 public:
  KeyWatch(std::string_view subject, ErrorKind kind) : subject_(subject), kind_(kind) {}

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_object(std::size_t) override { return open(false); }
  bool start_array(std::size_t) override { return open(true); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

  bool key(string_t& name) override {
    keys_.push_back(std::move(name));
    return true;
  }

 private:
  /// An object or array that is open. The keys of all open objects lie in one list; an object's are its end.
  struct Level {
    bool isArray;
    std::size_t index = 0;  ///< Of the element that comes next.
    std::size_t firstKey;
  };

  bool value() {
    if (!levels_.empty()) ++levels_.back().index;
    return true;
  }

  bool open(bool isArray) {
    levels_.push_back({isArray, 0, keys_.size()});
    return true;
  }

  bool close() {
    const Level level = levels_.back();
    if (!level.isArray) requireUnique(level.firstKey);
    levels_.pop_back();
    keys_.resize(level.firstKey);
    return value();
  }

  void requireUnique(std::size_t first) {
    const auto begin = keys_.begin() + std::ptrdiff_t(first);
    std::sort(begin, keys_.end());
    const auto twice = std::adjacent_find(begin, keys_.end());
    if (twice == keys_.end()) return;
    const std::string at = place();
    fail(kind_, subject_, "{}{}the key \"{}\" is given twice; keep one", at, at.empty() ? "" : ": ", *twice);
  }

  /// "materials[2].extras" of the innermost open object.
  std::string place() const {
    std::string text;
    for (std::size_t i = 0; i + 1 < levels_.size(); ++i) {
      if (levels_[i].isArray) {
        text += fmt::format("[{}]", levels_[i].index);
      } else {
        // The key of a member that is open is the last that its object has so far.
        text += (text.empty() ? "" : ".") + keys_[levels_[i + 1].firstKey - 1];
      }
    }
    return text;
  }

  std::string_view subject_;
  ErrorKind kind_;
  std::vector<Level> levels_;
  std::vector<std::string> keys_;
};

}  // namespace

void requireUniqueKeys(std::string_view text, std::string_view subject, ErrorKind kind) {
  KeyWatch watch(subject, kind);
  Json::sax_parse(text, &watch);
}

}  // namespace isophote
