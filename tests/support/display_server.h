// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <string>

namespace isophote {

/// An X server without a screen (Xvfb), under a number of its own choice; ends with the test program.
class DisplayServer {
 public:
  DisplayServer() {
    std::array<int, 2> ends{};
    if (::pipe2(ends.data(), O_CLOEXEC) != 0) return;
    process_ = ::fork();
    if (process_ == 0) serve(ends[1]);
    ::close(ends[1]);
    const std::string number = process_ > 0 ? lineFrom(ends[0]) : "";
    if (!number.empty()) name_ = ":" + number;
    ::close(ends[0]);
  }
  ~DisplayServer() {
    if (process_ <= 0) return;
    ::kill(process_, SIGTERM);
    ::waitpid(process_, nullptr, 0);
  }
  DisplayServer(const DisplayServer&) = delete;
  DisplayServer& operator=(const DisplayServer&) = delete;

  /// For the variable DISPLAY; empty where there is no Xvfb.
  const std::string& name() const { return name_; }

 private:
  /// A line, which may come in pieces; empty where none comes for a minute.
  static std::string lineFrom(int stream) {
    constexpr int kMilliseconds = 60'000;
    pollfd answer{stream, POLLIN, 0};
    std::string line;
    for (char c = 0; ::poll(&answer, 1, kMilliseconds) == 1 && ::read(stream, &c, 1) == 1; line += c)
      if (c == '\n') return line;
    return {};
  }

  [[noreturn]] static void serve(int answer) {
    ::prctl(PR_SET_PDEATHSIG, SIGTERM);
    constexpr int kAnswer = 3;
    if (answer == kAnswer)
      ::fcntl(answer, F_SETFD, 0);
    else
      ::dup2(answer, kAnswer);
    const int nowhere = ::open("/dev/null", O_RDWR);
    for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) ::dup2(nowhere, stream);
    ::execlp("Xvfb", "Xvfb", "-displayfd", "3", "-screen", "0", "1920x1200x24", "-nolisten", "tcp",
             static_cast<char*>(nullptr));
    ::_exit(127);
  }

  pid_t process_ = -1;
  std::string name_;
};

}  // namespace isophote
