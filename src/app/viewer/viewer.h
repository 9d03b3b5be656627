// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "app/viewer/script.h"
#include "app/viewer/session.h"
#include "base/job.h"
#include "trace/trace_scene.h"

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace isophote::viewer {

class Window;

/// A scene, its window and a person: what `isophote view` is once its options have been read.
class Viewer {
 public:
  /// Opens the window, hidden as yet: throws Error(kDevice) at once where there is none to be had. With a
  /// script, input comes from it alone, and the viewer closes at its end.
  Viewer(std::string sceneName, std::vector<ScriptCommand> script, std::filesystem::path scriptFile);
  ~Viewer();
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;

  /// Shows the session until it is closed. `trace` belongs to the viewer meanwhile. Prints what the script
  /// asks for to stdout. Throws Error(kStopped) where job.stop asks for it.
  void run(Session& session, TraceScene& trace, const Job& job);

 private:
  std::string sceneName_;
  std::vector<ScriptCommand> script_;
  std::filesystem::path scriptFile_;
  std::unique_ptr<Window> window_;
};

}  // namespace isophote::viewer
