// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "app/cli/manual.h"
#include "base/error.h"
#include "image/tonemap.h"
#include "render/quality.h"
#include "render/settings.h"
#include "scene/builtin/builtin.h"
#include "settings/apply.h"

#include <fmt/ranges.h>

#include <algorithm>

namespace isophote::cli {
namespace {

std::vector<std::string> settingKeys() {
  RenderSettings settings;
  std::vector<std::string> keys;
  for (const Field& field : fieldsOfGroups(settings)) keys.push_back(field.key + "=");
  return keys;
}

/// Names that an enumerated setting takes: of the first one whose key ends in the option's name.
std::vector<std::string> enumNames(const std::string& option) {
  RenderSettings settings;
  DisplayOptions display;
  std::vector<Field> fields = fieldsOfGroups(settings);
  for (const Field& field : fieldsOf(display)) fields.push_back(field);
  for (const Field& field : fields) {
    std::string name = field.key.substr(field.key.find('.') + 1);
    std::transform(name.begin(), name.end(), name.begin(), [](char c) { return char(std::tolower(c)); });
    const auto* names = std::get_if<EnumRef>(&field.value);
    if (names && name == option) return {names->names.begin(), names->names.end()};
  }
  return {};
}

/// What may follow an option, where that is a known set of words.
std::vector<std::string> wordsAfter(const CLI::Option& option) {
  const std::string name = option.get_lnames().empty() ? "" : option.get_lnames().front();
  std::vector<std::string> words;
  if (name == "set") return settingKeys();
  if (name == "engine") return {"auto", "cpu"};
  if (name == "layer") return {"direct", "indirect", "emitted"};
  if (name == "completion") return {"bash", "zsh"};
  if (name == "preset")
    for (const PresetInfo& preset : presets()) words.emplace_back(preset.name);
  if (name == "quality")
    for (const Quality& quality : qualities()) words.emplace_back(quality.name);
  return words.empty() ? enumNames(name) : words;
}

std::vector<const CLI::App*> commandsOf(const CLI::App& program) {
  return program.get_subcommands([](const CLI::App*) { return true; });
}

std::vector<std::string> namesOf(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  names.reserve(commands.size());
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::vector<std::string> optionNames(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames()) names.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
  return names;
}

bool takesValue(const CLI::Option& option) {
  return !option.get_positional() && option.get_items_expected_max() > 0;
}

std::vector<std::string> sceneNames() {
  std::vector<std::string> names;
  for (const BuiltinScene& scene : builtinScenes()) names.emplace_back(scene.name);
  return names;
}

/// What a command's arguments without a dash may be, besides files.
std::vector<std::string> argumentWords(const CLI::App& command) {
  const std::string& name = command.get_name();
  if (name == "compare") return {};
  if (name == "bench") return suiteNames();
  return sceneNames();
}

/// One case of the shell's switch for each command: its options, and what may follow each of them.
std::string bashCommand(const CLI::App& command) {
  std::vector<std::string> all;
  std::string cases;
  for (const CLI::Option* option : command.get_options()) {
    const std::vector<std::string> names = optionNames(*option);
    all.insert(all.end(), names.begin(), names.end());
    if (!takesValue(*option) || names.empty()) continue;
    const std::vector<std::string> words = wordsAfter(*option);
    const std::string type = option->get_type_name();
    const bool file = type == "FILE" || type == "FOLDER";
    cases += fmt::format("        {}) {} ;;\n", fmt::join(names, "|"),
                         file            ? "files=yes"
                         : words.empty() ? "words="
                                         : fmt::format("words=\"{}\"", fmt::join(words, " ")));
  }
  return fmt::format(
      "    {})\n      case $previous in\n{}        *) case $current in -*) words=\"{}\" ;; *) words=\"{}\"; "
      "files=yes ;; esac ;;\n      esac ;;\n",
      command.get_name(), cases, fmt::join(all, " "), fmt::join(argumentWords(command), " "));
}

std::string bashScript(const CLI::App& program) {
  const auto commands = commandsOf(program);
  std::string cases;
  for (const CLI::App* command : commands) cases += bashCommand(*command);
  return fmt::format(R"(# bash completion for isophote; written by `isophote info --completion bash`.
_isophote() {{
  local current=${{COMP_WORDS[COMP_CWORD]}} previous=${{COMP_WORDS[COMP_CWORD-1]}} words= files=
  # Bash cuts words at `=`.
  if [ "$current" = "=" ] || [ "$previous" = "=" ]; then return; fi
  if [ "$COMP_CWORD" -eq 1 ]; then
    COMPREPLY=($(compgen -W "{} --help --version" -- "$current"))
    return
  fi
  case ${{COMP_WORDS[1]}} in
{}  esac
  COMPREPLY=($(compgen -W "$words" -- "$current"))
  if [ -n "$files" ]; then COMPREPLY+=($(compgen -f -- "$current")); compopt -o filenames 2>/dev/null; fi
  case ${{COMPREPLY[0]}} in *=) compopt -o nospace 2>/dev/null ;; esac
}}
complete -F _isophote isophote
)",
                     fmt::join(namesOf(commands), " "), cases);
}

/// Text inside zsh's single quotes and a specification's brackets.
std::string zshText(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '\'') {
      out += "'\\''";
      continue;
    }
    if (c == '[' || c == ']' || c == ':' || c == '\\') out += '\\';
    out += c;
  }
  return out;
}

std::string zshOption(const CLI::Option& option, std::string_view name) {
  std::string action;
  if (takesValue(option)) {
    const std::vector<std::string> words = wordsAfter(option);
    const std::string type = option.get_type_name();
    action = fmt::format(":{}:{}", zshText(type),
                         type == "FOLDER" ? "_files -/"
                         : type == "FILE" ? "_files"
                         : words.empty()  ? " "
                                          : fmt::format("({})", fmt::join(words, " ")));
  }
  return fmt::format("        '*{}[{}]{}' \\\n", name, zshText(option.get_description()), action);
}

std::string zshScript(const CLI::App& program) {
  std::string names, cases;
  for (const CLI::App* command : commandsOf(program)) {
    names += fmt::format("    '{}:{}'\n", command->get_name(), zshText(command->get_description()));
    cases += fmt::format("    {})\n      _arguments -S \\\n", command->get_name());
    for (const CLI::Option* option : command->get_options())
      for (const std::string& name : optionNames(*option)) cases += zshOption(*option, name);
    const std::string words = fmt::format("{}", fmt::join(argumentWords(*command), " "));
    cases += command->get_name() == "compare" ? "        '*:picture:_files' ;;\n"
             : command->get_name() == "bench"
                 ? fmt::format("        '1:suite:({})' ;;\n", words)
                 : fmt::format("        '*:scene:{{ compadd {}; _files }}' ;;\n", words);
  }
  return fmt::format(R"(#compdef isophote
# zsh completion for isophote; written by `isophote info --completion zsh`.
_isophote() {{
  local -a commands
  commands=(
{}  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=$words[2]
  shift words
  (( CURRENT-- ))
  case $command in
{}  esac
}}
_isophote "$@"
)",
                     names, cases);
}

}  // namespace

std::string completionScript(const CLI::App& program, std::string_view shell) {
  if (shell == "bash") return bashScript(program);
  if (shell == "zsh") return zshScript(program);
  failUsage("--completion", "there is no completion for \"{}\"; there is bash, zsh", shell);
}

}  // namespace isophote::cli
