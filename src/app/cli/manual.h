// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace isophote::cli {

/// The program's manual page, in roff, from its commands and options.
std::string manualPage(const CLI::App& program);

/// A script with which that shell ("bash" or "zsh") completes commands, options, values and keys of --set.
/// Throws Error(kBadUsage) for another shell.
std::string completionScript(const CLI::App& program, std::string_view shell);

}  // namespace isophote::cli
