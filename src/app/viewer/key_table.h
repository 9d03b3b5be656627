// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "math/shared.h"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::viewer {

/// A key by the number that GLFW gives it: letters and digits are their own ASCII capitals.
using Key = int;
inline constexpr Key kKeySpace = 32, kKeyMinus = 45, kKeyEqual = 61, kKeyEscape = 256, kKeyTab = 258;

/// A key and what is held down with it.
struct KeyPress {
  Key key = 0;
  bool shift = false;
  bool control = false;

  bool operator==(const KeyPress&) const = default;
};

/// "W", "Shift+P", "Ctrl+Q", "Space", "-".
std::string keyName(KeyPress press);
/// The reverse, whatever the case; none where there is no such key.
std::optional<KeyPress> parseKey(std::string_view name);

/// What a key does: something once, when it goes down, or something as long as it is held.
struct KeyBinding {
  KeyPress press;
  std::string help;               ///< One sentence without its stop.
  std::function<void()> action;   ///< Empty: the key counts while it is held.
  std::optional<vec3> way = {};   ///< Flies that way while held: right, up, forward.
  std::optional<vec3> axis = {};  ///< While held, lights are dragged along it.
};

/// The keys of the viewer. Help shows this table itself, so that it cannot differ from what keys do.
class KeyTable {
 public:
  /// Throws Error(kInternal) where the key does something already.
  void add(KeyBinding binding);
  std::span<const KeyBinding> bindings() const { return bindings_; }
  /// What a press does; null: nothing. Keys that count while held do so with shift, too.
  const KeyBinding* find(KeyPress press) const;
  /// The table in Markdown.
  std::string markdown() const;

 private:
  std::vector<KeyBinding> bindings_;
};

}  // namespace isophote::viewer
