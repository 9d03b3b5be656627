// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/key_table.h"

#include "base/error.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace isophote::viewer {

namespace {

struct NamedKey {
  std::string_view name;
  Key key;
};
constexpr std::array<NamedKey, 3> kNamedKeys{
    {{"Space", kKeySpace}, {"Escape", kKeyEscape}, {"Tab", kKeyTab}}};

bool isPlain(Key key) {
  return (key >= 'A' && key <= 'Z') || (key >= '0' && key <= '9') || key == kKeyMinus || key == kKeyEqual;
}

bool sameWord(std::string_view a, std::string_view b) {
  return std::ranges::equal(
      a, b, [](unsigned char x, unsigned char y) { return std::tolower(x) == std::tolower(y); });
}

}  // namespace

std::string keyName(KeyPress press) {
  std::string name = press.control ? "Ctrl+" : "";
  if (press.shift) name += "Shift+";
  for (const NamedKey& named : kNamedKeys)
    if (named.key == press.key) return name.append(named.name);
  return isPlain(press.key) ? name + char(press.key) : name + fmt::format("key {}", press.key);
}

std::optional<KeyPress> parseKey(std::string_view name) {
  KeyPress press;
  for (auto plus = name.find('+'); plus != std::string_view::npos; plus = name.find('+')) {
    const std::string_view modifier = name.substr(0, plus);
    if (sameWord(modifier, "shift"))
      press.shift = true;
    else if (sameWord(modifier, "ctrl"))
      press.control = true;
    else
      return std::nullopt;
    name.remove_prefix(plus + 1);
  }
  for (const NamedKey& named : kNamedKeys)
    if (sameWord(named.name, name)) press.key = named.key;
  if (name.size() == 1) press.key = std::toupper(static_cast<unsigned char>(name.front()));
  if (press.key == 0 || (name.size() == 1 && !isPlain(press.key))) return std::nullopt;
  return press;
}

void KeyTable::add(KeyBinding binding) {
  if (find(binding.press))
    fail(ErrorKind::kInternal, "", "the key {} does two things", keyName(binding.press));
  bindings_.push_back(std::move(binding));
}

const KeyBinding* KeyTable::find(KeyPress press) const {
  for (const KeyBinding& binding : bindings_) {
    if (binding.press == press) return &binding;
    const bool held = !binding.action && binding.press.key == press.key && !press.control;
    if (held) return &binding;
  }
  return nullptr;
}

std::string KeyTable::markdown() const {
  std::string table = "| key | does |\n|---|---|\n";
  for (const KeyBinding& binding : bindings_)
    table += fmt::format("| {} | {} |\n", keyName(binding.press), binding.help);
  return table;
}

}  // namespace isophote::viewer
