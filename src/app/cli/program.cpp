// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/cli/command.h"
#include "base/error.h"
#include "settings/apply.h"
#include "settings/suggest.h"

#include <fmt/ranges.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <memory>
#include <new>
#include <system_error>
#include <thread>

namespace isophote::cli {
namespace {

constexpr int kExitBadInput = 1;
constexpr int kExitBadUsage = 2;
constexpr int kExitInterrupted = 130;

int exitCode(ErrorKind kind) {
  switch (kind) {
    case ErrorKind::kBadUsage:
      return kExitBadUsage;
    case ErrorKind::kStopped:
      return kExitInterrupted;
    default:
      return kExitBadInput;
  }
}

/// Turns SIGINT and SIGTERM into a request to stop; another one, later, ends the process at once. To be
/// called before any other thread exists, since threads inherit which signals they leave alone.
std::stop_source stopOnSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::stop_source source;
  // Waits until the process ends, so nobody joins it.
  std::thread([signals, source]() mutable {
    int number = 0;
    sigwait(&signals, &number);
    source.request_stop();
    // One key press may arrive twice: through the process group and through the parent (`timeout` does that).
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    const timespec now{};
    while (sigtimedwait(&signals, nullptr, &now) > 0) {
    }
    sigwait(&signals, &number);
    _exit(kExitInterrupted);
  }).detach();
  return source;
}

/// "render, reference, view, compare, info"
std::vector<std::string> commandNames(const CLI::App& program) {
  std::vector<std::string> names;
  for (const CLI::App* command : program.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(command->get_name());
  return names;
}

void requireCommand(const CLI::App& program, int argc, const char* const* argv) {
  const std::vector<std::string> names = commandNames(program);
  if (argc < 2) failUsage("", "give a command: {} (isophote --help shows examples)", fmt::join(names, ", "));
  const std::string_view first = argv[1];
  if (first.starts_with('-') || std::find(names.begin(), names.end(), first) != names.end()) return;
  failUsage("", "there is no command \"{}\"{}; there is {}", first, suggestion(first, names),
            fmt::join(names, ", "));
}

std::vector<std::string> optionNames(const CLI::App& parser) {
  std::vector<std::string> names;
  for (const CLI::Option* option : parser.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  return names;
}

/// What the parser objects to, as one sentence that proposes the nearest option.
[[noreturn]] void failParse(const CLI::App& program, const CLI::ParseError& error) {
  const std::vector<CLI::App*> parsed = program.get_subcommands();
  const CLI::App& parser = parsed.empty() ? program : *parsed.front();
  const std::string help =
      parsed.empty() ? "isophote --help" : fmt::format("isophote {} --help", parser.get_name());
  for (const std::string& extra : program.remaining(true)) {
    if (extra.starts_with('-')) {
      const std::string option = extra.substr(0, extra.find('='));
      const std::string nearest = suggestion(option, optionNames(parser));
      failUsage("", "there is no option {}{}", option,
                nearest.empty() ? fmt::format("; {} lists all", help) : nearest);
    }
    failUsage("", "there is one argument too many: \"{}\" ({} shows what is taken)", extra, help);
  }
  const std::string what = error.what();
  const std::string option = what.substr(0, what.find(':'));
  if (error.get_name() == "ArgumentMismatch" && option.starts_with('-'))
    failUsage(option, "takes one value ({} shows which)", help);
  failUsage("", "{} ({} shows how)", what, help);
}

/// An empty value is a script's variable that was never set: taking it for "not given" would hide that.
void requireValues(const CLI::App& parser) {
  for (const CLI::Option* option : parser.get_options()) {
    const std::vector<std::string>& values = option->results();
    if (std::find(values.begin(), values.end(), "") != values.end())
      failUsage(option->get_name(), "is empty; give it a value or leave it out");
  }
}

struct ThreadSettings {
  int threads = 0;
  void visit(auto&& v) { v("threads", threads, {.help = "Number of threads.", .min = 1, .max = 4096}); }
};

/// The number of threads that was asked for; 0: all.
int threadCount(const std::string& text) {
  ThreadSettings settings;
  if (!text.empty()) setSetting(fieldsOf(settings), "threads", text, {ErrorKind::kBadUsage, "--threads"});
  return settings.threads;
}

/// Bytes that "512", "512M" or "4G" stand for; the unit is MiB or GiB.
std::uint64_t memoryBudget(std::string_view text) {
  std::string_view digits = text;
  int shift = 20;
  if (!digits.empty() && (digits.back() == 'M' || digits.back() == 'G')) {
    shift = digits.back() == 'G' ? 30 : 20;
    digits.remove_suffix(1);
  }
  std::uint64_t count = 0;
  const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  constexpr std::uint64_t kMost = std::uint64_t(1) << 32;  // 4 PiB in MiB, and no overflow in GiB.
  if (problem != std::errc() || end != digits.data() + digits.size() || count < 1 || count > kMost)
    failUsage("--memory", "\"{}\" is not a size such as 512M or 4G", text);
  return count << shift;
}

void runWithThreads(int threads, const std::function<void()>& work) {
  if (threads == 0) return work();
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
  tbb::task_arena arena(threads);
  arena.execute(work);
}

void setUpProgram(CLI::App& program) {
  program.name("isophote");
  program.get_formatter()->label("SUBCOMMAND", "COMMAND");
  program.set_version_flag("--version", std::string("isophote ") + ISOPHOTE_VERSION);
  program.footer(
      "\nExamples:\n"
      "  isophote render cornell-box -o cornell.png\n"
      "  isophote reference cornell-box -o reference.exr --spp 256\n"
      "  isophote compare a.exr b.exr\n"
      "  isophote info --builtin\n"
      "isophote COMMAND --help describes one command.");
}

/// Parses and runs. Returns the exit code where there was no error.
int parseAndRun(int argc, const char* const* argv, std::unique_ptr<Console>& console) {
  CLI::App program("Photon mapping: lights scenes globally, and path-traces them for comparison.");
  setUpProgram(program);
  WorkOptions work;
  const Command commands[] = {addRender(program, work), addReference(program, work),
                              addView(program, work),   addCompare(program),
                              addInfo(program),         addBench(program, work)};
  for (const Command& command : commands) command.parser->group("Commands");
  requireCommand(program, argc, argv);
  try {
    program.parse(argc, argv);
  } catch (const CLI::Success& helpOrVersion) {
    return program.exit(helpOrVersion);
  } catch (const CLI::ParseError& error) {
    failParse(program, error);
  }

  for (const CLI::App* parser : program.get_subcommands()) requireValues(*parser);
  const int threads = threadCount(work.threads);
  const std::stop_source stop = stopOnSignals();
  console = std::make_unique<Console>(work.quiet);
  Job job;
  job.stop = stop.get_token();
  if (!work.memory.empty()) job.memoryBudgetBytes = memoryBudget(work.memory);
  job.progress = [&](std::string_view task, double fraction) { console->progress(task, fraction); };
  job.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::kWarning) console->warn(message);
  };
  Host host{*console, job};
  for (const Command& command : commands)
    if (command.parser->parsed()) runWithThreads(threads, [&] { command.run(host); });
  return 0;
}

}  // namespace

void addWorkOptions(CLI::App& parser, WorkOptions& work) {
  parser.add_option("--threads", work.threads, "Number of threads; the picture does not depend on it [all]")
      ->type_name("N")
      ->take_last();
  parser
      .add_option("--memory", work.memory,
                  "Refuse what would need more memory than this, in MiB, or with a unit as in 4G [16G]")
      ->type_name("SIZE")
      ->take_last();
  parser.add_flag("--quiet", work.quiet, "Show neither progress nor warnings");
}

int runProgram(int argc, const char* const* argv) {
  std::unique_ptr<Console> console;
  const auto say = [&](std::string_view sentence) {
    if (!console) console = std::make_unique<Console>(true);
    console->error(sentence);
  };
  try {
    const int code = parseAndRun(argc, argv, console);
    // What a flush before this one lost only the error flag remembers.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
      fail(ErrorKind::kResources, "", "what was to be printed could not be written");
    return code;
  } catch (const Error& error) {
    say(error.what());
    return exitCode(error.kind());
  } catch (const std::bad_alloc&) {
    say("memory does not suffice; a smaller picture, fewer photons or a simpler scene would need less");
  } catch (const std::system_error& error) {
    say(error.what());  // Of a full disk that stdout goes to, for one.
  } catch (const std::exception& error) {
    say(fmt::format("internal error: {}", error.what()));
  }
  return kExitBadInput;
}

}  // namespace isophote::cli
