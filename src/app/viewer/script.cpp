// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/viewer/script.h"

#include "base/error.h"
#include "image/files.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>

#include <array>
#include <charconv>
#include <cmath>

namespace isophote::viewer {

namespace {

/// The words of one line, taken one by one.
class Line {
 public:
  Line(std::string_view text, std::size_t number, const std::string& subject)
      : number_(number), subject_(subject) {
    constexpr std::string_view kBlank = " \t\r";
    text = text.substr(0, text.find('#'));
    for (auto begin = text.find_first_not_of(kBlank); begin != std::string_view::npos;
         begin = text.find_first_not_of(kBlank)) {
      text.remove_prefix(begin);
      words_.push_back(text.substr(0, text.find_first_of(kBlank)));
      text.remove_prefix(words_.back().size());
    }
  }

  bool empty() const { return words_.empty(); }
  std::size_t number() const { return number_; }
  /// Whether there is another word.
  bool more() const { return next_ < words_.size(); }

  template <class... Args>
  [[noreturn]] void refuse(fmt::format_string<Args...> sentence, Args&&... args) const {
    failInput(subject_, "line {}: {}", number_, fmt::format(sentence, std::forward<Args>(args)...));
  }

  /// `form` is how the command is written, for the sentence of an error.
  std::string_view word(std::string_view form) {
    if (!more()) refuse("there is a word missing; write \"{}\"", form);
    return words_[next_++];
  }

  float number(std::string_view form) {
    const std::string_view text = word(form);
    float value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
      refuse("\"{}\" is not a number; write \"{}\"", text, form);
    return value;
  }

  std::uint32_t count(std::string_view form, std::uint32_t least, std::uint32_t most) {
    const std::string_view text = word(form);
    std::uint32_t value = 0;
    const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (problem != std::errc() || end != text.data() + text.size() || value < least || value > most)
      refuse("\"{}\" is not a whole number from {} to {}; write \"{}\"", text, least, most, form);
    return value;
  }

  vec3 vector(std::string_view form) {
    const float x = number(form), y = number(form);
    return {x, y, number(form)};
  }

  KeyPress key(std::string_view form) {
    const std::string_view name = word(form);
    const std::optional<KeyPress> press = parseKey(name);
    if (!press) refuse("there is no key \"{}\"; there are W, Shift+P, Ctrl+Q, Space, Tab, Escape, ...", name);
    return *press;
  }

  void end(std::string_view form) const {
    if (more()) refuse("\"{}\" is one word too many; write \"{}\"", words_[next_], form);
  }

 private:
  std::size_t number_;
  const std::string& subject_;
  std::vector<std::string_view> words_;
  std::size_t next_ = 0;
};

using What = decltype(ScriptCommand::what);

/// One command: its name, how it is written, and how it is read.
struct Syntax {
  std::string_view name;
  std::string_view form;
  What (*read)(Line& line, std::string_view form);
};

constexpr std::uint32_t kMany = 1'000'000;
constexpr std::uint32_t kLargestPicture = 16384;

MouseButton buttonOf(Line& line, std::string_view form) {
  const std::string_view name = line.word(form);
  if (name == "left") return MouseButton::kLeft;
  if (name == "right") return MouseButton::kRight;
  if (name == "middle") return MouseButton::kMiddle;
  line.refuse("there is no button \"{}\"; there is left, right, middle", name);
}

What readScreenshot(Line& line, std::string_view form) {
  std::string_view file = line.word(form);
  const bool window = file == "window" && line.more();
  if (window) file = line.word(form);
  const std::filesystem::path path(file);
  try {
    if (window && filmFormat(path) != FilmFormat::kPng) line.refuse("the window is kept as .png alone");
    requireFilmFormat(path);
  } catch (const Error& error) {
    if (error.kind() == ErrorKind::kBadInput) throw;
    line.refuse("{}", error.what());
  }
  return script::Screenshot{path, window};
}

What readSet(Line& line, std::string_view form) {
  const std::string_view assignment = line.word(form);
  const auto equals = assignment.find('=');
  if (equals == std::string_view::npos) line.refuse("write \"{}\"", form);
  return script::Set{std::string(assignment.substr(0, equals)), std::string(assignment.substr(equals + 1))};
}

What readPrint(Line& line, std::string_view form) {
  const std::string_view what = line.word(form);
  if (what == "state") return script::Print{script::Print::kState};
  if (what == "keys") return script::Print{script::Print::kKeys};
  line.refuse("\"{}\" cannot be printed; write \"{}\"", what, form);
}

constexpr std::array<Syntax, 15> kCommands{{
    {"wait", "wait PICTURES",
     [](Line& l, std::string_view form) -> What { return script::Wait{l.count(form, 1, kMany)}; }},
    {"passes", "passes N",
     [](Line& l, std::string_view form) -> What { return script::WaitPasses{l.count(form, 1, kMany)}; }},
    {"key", "key NAME", [](Line& l, std::string_view form) -> What { return script::PressKey{l.key(form)}; }},
    {"hold", "hold KEY SECONDS",
     [](Line& l, std::string_view form) -> What {
       const KeyPress press = l.key(form);
       return script::HoldKey{press, l.number(form)};
     }},
    {"mouse", "mouse X Y",
     [](Line& l, std::string_view form) -> What {
       const float x = l.number(form);
       return script::MovePointer{vec2(x, l.number(form))};
     }},
    {"press", "press left|right|middle",
     [](Line& l, std::string_view form) -> What {
       return script::PressButton{buttonOf(l, form), true};
     }},
    {"release", "release left|right|middle",
     [](Line& l, std::string_view form) -> What {
       return script::PressButton{buttonOf(l, form), false};
     }},
    {"wheel", "wheel NOTCHES",
     [](Line& l, std::string_view form) -> What { return script::TurnWheel{l.number(form)}; }},
    {"light", "light NUMBER X Y Z",
     [](Line& l, std::string_view form) -> What {
       const std::size_t light = l.count(form, 0, kMany);
       return script::MoveLight{light, l.vector(form)};
     }},
    {"set", "set KEY=VALUE", readSet},
    {"resize", "resize WIDTH HEIGHT",
     [](Line& l, std::string_view form) -> What {
       const auto width = int(l.count(form, 1, kLargestPicture));
       return script::Resize{width, int(l.count(form, 1, kLargestPicture))};
     }},
    {"screenshot", "screenshot [window] FILE", readScreenshot},
    {"benchmark", "benchmark LIGHT X Y Z PICTURES",
     [](Line& l, std::string_view form) -> What {
       const std::size_t light = l.count(form, 0, kMany);
       const vec3 to = l.vector(form);
       return script::Benchmark{light, to, l.count(form, 1, kMany)};
     }},
    {"print", "print state|keys", readPrint},
    {"quit", "quit", [](Line&, std::string_view) -> What { return script::Quit{}; }},
}};

}  // namespace

std::vector<ScriptCommand> parseScript(std::string_view text, const std::string& subject) {
  std::vector<std::string_view> names;
  names.reserve(kCommands.size());
  for (const Syntax& syntax : kCommands) names.push_back(syntax.name);
  std::vector<ScriptCommand> commands;
  for (std::size_t number = 1; !text.empty(); ++number) {
    Line line(text.substr(0, text.find('\n')), number, subject);
    text.remove_prefix(
        std::min(text.size(), text.find('\n') == std::string_view::npos ? text.size() : text.find('\n') + 1));
    if (line.empty()) continue;
    const std::string_view name = line.word("");
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end())
      line.refuse("there is no command \"{}\"{}; there is {}", name, suggestion(name, names),
                  fmt::join(names, ", "));
    const Syntax& syntax = kCommands[std::size_t(found - names.begin())];
    commands.push_back({number, syntax.read(line, syntax.form)});
    line.end(syntax.form);
  }
  return commands;
}

}  // namespace isophote::viewer
