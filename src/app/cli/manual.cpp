// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/manual.h"

#include "render/quality.h"
#include "render/settings.h"
#include "scene/builtin/builtin.h"
#include "settings/apply.h"

#include <fmt/ranges.h>

namespace isophote::cli {
namespace {

/// Text as roff shows it: backslashes and hyphens stand for themselves, and no line begins a request.
std::string roff(std::string_view text) {
  std::string out;
  bool lineBegins = true;
  for (const char c : text) {
    if (lineBegins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else
      out += c;
    lineBegins = c == '\n';
  }
  return out;
}

std::string optionHead(const CLI::Option& option) {
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames())
    names.push_back(fmt::format("\\fB{}\\fR", roff("-" + name)));
  for (const std::string& name : option.get_lnames())
    names.push_back(fmt::format("\\fB{}\\fR", roff("--" + name)));
  if (names.empty()) names.push_back(fmt::format("\\fI{}\\fR", roff(option.get_name(true))));
  const bool takesValue = option.get_items_expected_max() > 0 && !option.get_positional();
  return fmt::format("{}{}", fmt::join(names, ", "),
                     takesValue ? fmt::format(" \\fI{}\\fR", roff(option.get_type_name())) : "");
}

std::string commandSection(const CLI::App& command) {
  std::string page =
      fmt::format(".SS {}\n{}.\n", roff("isophote " + command.get_name()), roff(command.get_description()));
  for (const CLI::Option* option : command.get_options())
    page += fmt::format(".TP\n{}\n{}\n", optionHead(*option), roff(option->get_description()));
  if (!command.get_footer().empty()) page += fmt::format(".PP\n.nf\n{}\n.fi\n", roff(command.get_footer()));
  return page;
}

std::string settingsSection() {
  RenderSettings settings;
  std::string page = ".SH SETTINGS\nFor \\fB\\-\\-set\\fR, \\fB\\-\\-settings\\fR and scene descriptions.\n";
  for (const Field& field : fieldsOfGroups(settings)) {
    const std::string range = rangeText(field);
    page += fmt::format(".TP\n\\fB{}\\fR\n{} [{}{}{}]\n", roff(field.key), roff(field.info.help),
                        roff(valueText(field)), range.empty() ? "" : "; ", roff(range));
  }
  page += ".SH PRESETS\n";
  for (const PresetInfo& preset : presets())
    page += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(preset.name), roff(preset.description));
  page += ".SH QUALITIES\n";
  for (const Quality& quality : qualities())
    page += fmt::format(".TP\n\\fB{}\\fR\n{} {}\n", roff(quality.name), roff(quality.description),
                        roff(fmt::format("{}", fmt::join(quality.assignments, ", "))));
  return page;
}

}  // namespace

std::string manualPage(const CLI::App& program) {
  std::string page = fmt::format(
      ".TH ISOPHOTE 1 \"\" \"isophote {}\" \"User Commands\"\n"
      ".SH NAME\nisophote \\- light scenes with photons\n"
      ".SH SYNOPSIS\n\\fBisophote\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR] ...\n"
      ".SH DESCRIPTION\n{}\n.SH COMMANDS\n",
      ISOPHOTE_VERSION, roff(program.get_description()));
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    page += commandSection(*command);
  page += settingsSection();
  page += ".SH BUILT\\-IN SCENES\n";
  for (const BuiltinScene& scene : builtinScenes())
    page += fmt::format(".TP\n\\fB{}\\fR\n{}\n", roff(scene.name), roff(scene.description));
  page +=
      ".SH ENVIRONMENT\n.TP\n\\fBISOPHOTE_ASSETS\\fR\nFolders, separated by colons, in which models that a "
      "scene description names are searched.\n"
      ".TP\n\\fBISOPHOTE_SIMD\\fR\nThe widest instruction set to use: baseline, avx2 or avx512.\n"
      ".SH EXIT STATUS\n.TP\n0\nThe work is done.\n.TP\n1\nThe input is bad, or memory, disk or device do "
      "not "
      "suffice; nothing was written.\n.TP\n2\nThe options are bad.\n.TP\n130\nInterrupted; nothing was "
      "written.\n";
  return page;
}

}  // namespace isophote::cli
