// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/cli/console.h"
#include "base/job.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>
#include <vector>

namespace isophote::cli {

/// What every command is given when it runs.
struct Host {
  Console& console;
  Job job;
};

/// Options that commands doing long work share; main() acts on them.
struct WorkOptions {
  bool quiet = false;
  std::string threads;  ///< Empty: all.
  std::string memory;   ///< Empty: the default of Job.
};

/// A command of the program: after its parser has read the command line, `run` does the work. It throws
/// isophote::Error, whose kind decides the exit code.
struct Command {
  CLI::App* parser = nullptr;
  std::function<void(Host&)> run;
};

/// Adds --threads, --memory and --quiet to a command.
void addWorkOptions(CLI::App& parser, WorkOptions& work);

// Each adds one command to the program.
Command addRender(CLI::App& program, WorkOptions& work);
Command addReference(CLI::App& program, WorkOptions& work);
Command addCompare(CLI::App& program);
Command addInfo(CLI::App& program);
Command addBench(CLI::App& program, WorkOptions& work);
Command addView(CLI::App& program, WorkOptions& work);

/// What `isophote bench` measures: its suites, and "all".
std::vector<std::string> suiteNames();

/// Runs the program and returns its exit code: 0, 1 for bad input, 2 for bad usage, 130 where it was
/// interrupted.
int runProgram(int argc, const char* const* argv);

}  // namespace isophote::cli
