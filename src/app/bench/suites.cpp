// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "app/bench/suite.h"

#include <algorithm>
#include <array>

namespace isophote::bench {

std::span<const Suite* const> suites() {
  static constexpr std::array all{&kIspmSuite, &kIgpmSuite,       &kVschSuite,
                                  &kSspmSuite, &kEstimatorsSuite, &kQualitySuite};
  return all;
}

const Suite* findSuite(std::string_view name) {
  const auto all = suites();
  const auto found = std::ranges::find(all, name, &Suite::name);
  return found == all.end() ? nullptr : *found;
}

void runSuites(std::span<const Suite* const> chosen, const Options& options, Report& report, const Job& job,
               const std::function<void(const Table*)>& changed) {
  for (const Suite* suite : chosen)
    if (suite->check) suite->check(options);
  report.quick = options.quick;
  report.sections.reserve(chosen.size());  // What a suite hands in stays where it is.
  for (const Suite* suite : chosen) {
    Section& section = report.sections.emplace_back();
    section.suite = suite->name;
    section.description = suite->description;
    Context context(options, suite->quickSeconds, job, section, [&](const Table& table) {
      if (changed) changed(&table);
    });
    section.seconds = millisecondsOf([&] { suite->run(context); }) / 1000;
    if (changed) changed(nullptr);
  }
}

}  // namespace isophote::bench
