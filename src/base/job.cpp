// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "base/job.h"

#include "base/error.h"

namespace isophote {

Job Job::part(double begin, double end) const {
  Job job = *this;
  if (progress)
    job.progress = [whole = progress, begin, end](std::string_view task, double fraction) {
      whole(task, begin + (end - begin) * fraction);
    };
  return job;
}

void Job::report(std::string_view task, double fraction) const {
  if (progress) progress(task, fraction);
}

void Job::info(std::string_view message) const {
  if (log) log(LogLevel::kInfo, message);
}

void Job::warn(std::string_view message) const {
  if (log) log(LogLevel::kWarning, message);
}

void Job::throwIfStopped() const {
  if (stop.stop_requested()) fail(ErrorKind::kStopped, "", "stopped before the work was complete");
}

}  // namespace isophote
