// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/files.h"
#include "support/files.h"

#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <string>

namespace isophote {

/// What a run of the program came to; 128 + n where signal n ended it.
struct ProgramRun {
  int code = -1;
  std::string output;
  std::string errors;
};

/// Runs `isophote ARGUMENTS` in a folder, through the shell and, where given, under another command. Leaves
/// no file of its own there.
inline ProgramRun runIsophote(const std::filesystem::path& folder, const std::string& arguments,
                              const std::string& wrapper = "") {
  const std::filesystem::path output = folder.string() + ".stdout", errors = folder.string() + ".stderr";
  const std::string line =
      fmt::format("cd '{}' && {} '{}/bin/isophote' {} >'{}' 2>'{}' </dev/null", folder.string(), wrapper,
                  ISOPHOTE_BINARY_DIR, arguments, output.string(), errors.string());
  ProgramRun run;
  const int status = std::system(line.c_str());
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.output = readFile(output);
  run.errors = readFile(errors);
  std::filesystem::remove(output);
  std::filesystem::remove(errors);
  return run;
}

}  // namespace isophote
