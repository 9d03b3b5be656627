// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fuzz/format.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <cstddef>
#include <cstring>
#include <random>

namespace isophote::fuzz {

/// Damages files as disks, editors and attackers do. The same seed gives the same damage everywhere.
class Mutator {
 public:
  Mutator(const Format& format, std::uint32_t seed) : format_(format), random_(seed) {}

  /// One of the format's seeds with one to eight changes to its bytes, to the values of its JSON, or to both.
  std::string next() {
    std::string bytes = pick(format_.seeds);
    if (format_.jsonPart && below(4) != 0) {
      changeJson(bytes);
      if (below(4) != 0) return bytes;
    }
    const std::size_t changes = std::size_t(1) << below(4);
    for (std::size_t i = 0; i < changes; ++i) change(bytes);
    if (bytes.size() > kMostBytes) bytes.resize(kMostBytes);
    if (format_.repair && below(4) != 0) format_.repair(bytes);
    return bytes;
  }

 private:
  static constexpr std::size_t kMostBytes = 1 << 16;
  /// Where signs, sizes and products of sizes go wrong.
  static constexpr std::array<std::uint64_t, 16> kNumbers{0,
                                                          1,
                                                          2,
                                                          0x7f,
                                                          0x80,
                                                          0xff,
                                                          0x7fff,
                                                          0x8000,
                                                          0xffff,
                                                          0x10000,
                                                          0x7fffffff,
                                                          0x80000000,
                                                          0xffffffff,
                                                          0x40000001,
                                                          0x7fffffffffffffff,
                                                          ~std::uint64_t(0)};

  std::size_t below(std::size_t bound) { return bound == 0 ? 0 : random_() % bound; }
  const std::string& pick(const std::vector<std::string>& list) { return list[below(list.size())]; }

  void change(std::string& bytes) {
    switch (below(12)) {
      case 0:
        return flipBit(bytes);
      case 1:
      case 2:
        return overwriteNumber(bytes);
      case 3:
      case 4:
        return replaceDigits(bytes);
      case 5:
      case 6:
        return insertWord(bytes);
      case 7:
        return erase(bytes);
      case 8:
        return repeat(bytes);
      case 9:
        return moveWithin(bytes);
      case 10:
        return splice(bytes);
      default:
        return below(4) == 0 ? bytes.resize(below(bytes.size() + 1)) : setByte(bytes);
    }
  }

  void flipBit(std::string& bytes) {
    if (!bytes.empty()) bytes[below(bytes.size())] ^= char(1u << below(8));
  }
  void setByte(std::string& bytes) {
    if (!bytes.empty()) bytes[below(bytes.size())] = char(below(256));
  }

  /// One to eight bytes become a binary number, of either byte order.
  void overwriteNumber(std::string& bytes) {
    const std::size_t size = std::size_t(1) << below(4);
    if (bytes.size() < size) return;
    std::array<char, 8> number{};
    const std::uint64_t value = kNumbers[below(kNumbers.size())];
    for (std::size_t i = 0; i < size; ++i) number[i] = char(value >> (8 * i));
    if (below(2) == 0) std::reverse(number.begin(), number.begin() + std::ptrdiff_t(size));
    std::memcpy(bytes.data() + below(bytes.size() - size + 1), number.data(), size);
  }

  /// A decimal number in the text becomes another one.
  void replaceDigits(std::string& bytes) {
    static const std::vector<std::string> kTexts{"0",
                                                 "-1",
                                                 "1",
                                                 "2",
                                                 "3",
                                                 "5",
                                                 "1e-45",
                                                 "1e30",
                                                 "-1e38",
                                                 "1e999",
                                                 "255",
                                                 "65535",
                                                 "65536",
                                                 "2147483647",
                                                 "0.5",
                                                 "nan",
                                                 "1.",
                                                 "4294967295",
                                                 "-0",
                                                 "inf",
                                                 "2147483648",
                                                 "4294967296",
                                                 "18446744073709551615",
                                                 "1e300",
                                                 "007",
                                                 "1,5"};
    const std::size_t start = below(bytes.size());
    const auto isDigit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
    const auto first = std::find_if(bytes.begin() + std::ptrdiff_t(start), bytes.end(), isDigit);
    if (first == bytes.end()) return setByte(bytes);
    const auto last = std::find_if_not(first, bytes.end(), isDigit);
    bytes.replace(first, last, pick(kTexts));
  }

  void insertWord(std::string& bytes) {
    if (format_.words.empty()) return setByte(bytes);
    const std::string& word = pick(format_.words);
    const std::size_t at = below(bytes.size() + 1);
    if (below(2) == 0 && at + word.size() <= bytes.size()) {
      bytes.replace(at, word.size(), word);
    } else {
      bytes.insert(at, word);
    }
  }

  /// A few bytes, sometimes many.
  std::size_t length(std::size_t most) { return std::min(most, below(below(4) == 0 ? most + 1 : 16)); }

  void erase(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1);
    bytes.erase(at, length(bytes.size() - at));
  }
  void repeat(std::string& bytes) {
    const std::size_t at = below(bytes.size() + 1);
    const std::string part = bytes.substr(at, length(bytes.size() - at));
    for (std::size_t times = below(8) == 0 ? 50 : 1; times > 0; --times) bytes.insert(at, part);
  }
  void moveWithin(std::string& bytes) {
    const std::size_t from = below(bytes.size() + 1);
    const std::string part = bytes.substr(from, length(bytes.size() - from));
    bytes.replace(below(bytes.size() + 1), part.size(), part);
  }
  /// The front of one file with the end of another.
  void splice(std::string& bytes) {
    const std::string& other = pick(format_.seeds);
    bytes = bytes.substr(0, below(bytes.size() + 1)) + other.substr(below(other.size() + 1));
  }

  /// Changes one to four values of the JSON, which stays valid JSON.
  void changeJson(std::string& bytes) {
    const auto [at, size] = format_.jsonPart(bytes);
    nlohmann::json json = nlohmann::json::parse(bytes.substr(at, size));
    for (std::size_t i = below(4) + 1; i > 0; --i) {
      std::vector<nlohmann::json*> values;
      collect(json, values);
      changeValue(*values[below(values.size())], *values[below(values.size())]);
    }
    bytes.replace(at, size, json.dump());
    if (format_.repair) format_.repair(bytes);
  }

  static void collect(nlohmann::json& value, std::vector<nlohmann::json*>& values) {
    values.push_back(&value);
    if (value.is_structured())
      for (nlohmann::json& member : value) collect(member, values);
  }

  void changeValue(nlohmann::json& value, const nlohmann::json& other) {
    switch (below(6)) {
      case 0:
        if (!value.empty() && value.is_array()) value.erase(below(value.size()));
        if (!value.empty() && value.is_object())
          value.erase(std::next(value.begin(), std::ptrdiff_t(below(value.size()))));
        return;
      case 1:
        if (value.is_array() && !value.empty()) value.push_back(nlohmann::json(value[below(value.size())]));
        return;
      case 2:
        value = nlohmann::json(other);  // A copy: `other` may lie within `value`.
        return;
      case 3:
        if (value.is_number()) value = value.get<double>() * 0.5 - 1.0;
        return;
      case 4:
        if (value.is_number_integer()) value = value.get<std::int64_t>() + std::int64_t(below(5)) - 2;
        return;
      default: {
        static const std::vector<nlohmann::json> kValues{0,
                                                         1,
                                                         -1,
                                                         2,
                                                         0.5,
                                                         3.0,
                                                         1e-40,
                                                         1e30,
                                                         -1e38,
                                                         255,
                                                         256,
                                                         65535,
                                                         65536,
                                                         2147483647,
                                                         4294967295u,
                                                         5120,
                                                         5123,
                                                         5126,
                                                         true,
                                                         nullptr,
                                                         "",
                                                         "a\x01\nb",
                                                         "data:,",
                                                         "SCALAR",
                                                         "VEC4",
                                                         9007199254740992,
                                                         1e300,
                                                         nlohmann::json::array(),
                                                         nlohmann::json::object(),
                                                         std::string(3000, 'x')};
        value = kValues[below(kValues.size())];
      }
    }
  }

  const Format& format_;
  std::mt19937 random_;
};

}  // namespace isophote::fuzz
