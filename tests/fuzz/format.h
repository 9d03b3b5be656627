// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace isophote::fuzz {

/// Most that reading one input may allocate [bytes]: job.memoryBudgetBytes.
inline constexpr std::uint64_t kBudgetBytes = std::uint64_t(64) << 20;

/// A kind of file that Isophote reads, for mutation_test.cpp and for libFuzzer (fuzz_target.cpp).
struct Format {
  std::string name;
  /// Small valid files.
  std::vector<std::string> seeds;
  /// What the format's files are made of: mutations insert these.
  std::vector<std::string> words;
  /// Reads the bytes and uses what they hold. Throws Error where they are refused; anything else that happens
  /// is a bug.
  std::function<void(const std::string& bytes)> read;
  /// Puts check sums and lengths right, so that mutations reach what lies behind them. May be empty.
  std::function<void(std::string& bytes)> repair{};
  /// Offset and length of the JSON in a valid file, where there is some: its values are changed too, not only
  /// its bytes, of which few can be changed without ending a parser's work. May be empty.
  std::function<std::pair<std::size_t, std::size_t>(const std::string& bytes)> jsonPart{};
};

inline std::uint64_t hashOf(std::string_view bytes) {
  std::uint64_t hash = 14695981039346656037u;  // FNV-1a
  for (const char c : bytes) hash = (hash ^ std::uint8_t(c)) * 1099511628211u;
  return hash ^ (hash >> 32);
}

}  // namespace isophote::fuzz
