// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// libFuzzer's side: one program a format, which fuzz_format.cpp names. With --write-seeds FOLDER, before
// any other argument, it writes its seeds and its dictionary there instead.
#include "fuzz/scene_formats.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

namespace isophote::fuzz {

extern const char* const kFuzzFormat;

namespace {

std::filesystem::path inputFolder() {
  std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("isophote-fuzz-{}", ::getpid());
  std::filesystem::create_directories(folder);
  return folder;
}

const Format& format() {
  static const Format kFormat = [] {
    static const std::filesystem::path kFolder = inputFolder();
    std::atexit([] { std::filesystem::remove_all(kFolder); });
    for (Format& candidate : allFormats(kFolder))
      if (candidate.name == kFuzzFormat) return candidate;
    std::fprintf(stderr, "there is no format %s\n", kFuzzFormat);
    std::abort();
  }();
  return kFormat;
}

/// A line of libFuzzer's dictionary: "word", with \xAB for bytes that are no plain letters.
std::string dictionaryLine(const std::string& word) {
  std::string line = "\"";
  for (const char c : word) {
    const bool plain = c > ' ' && c < 127 && c != '"' && c != '\\';
    line += plain ? std::string(1, c) : fmt::format("\\x{:02X}", std::uint8_t(c));
  }
  return line + "\"\n";
}

void writeSeeds(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder / format().name);
  for (std::size_t i = 0; i < format().seeds.size(); ++i)
    writeBytes(folder / format().name / fmt::format("seed{}", i), format().seeds[i]);
  std::string dictionary;
  for (const std::string& word : format().words) dictionary += dictionaryLine(word);
  writeBytes(folder / (format().name + ".dict"), dictionary);
}

}  // namespace
}  // namespace isophote::fuzz

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  if (*argc < 3 || std::string_view((*argv)[1]) != "--write-seeds") return 0;
  isophote::fuzz::writeSeeds((*argv)[2]);
  std::exit(0);
}

/// As libFuzzer mutates, with check sums and lengths put right three times in four.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t maxSize,
                                               unsigned seed) {
  size = LLVMFuzzerMutate(data, size, maxSize);
  const isophote::fuzz::Format& format = isophote::fuzz::format();
  if (!format.repair || seed % 4 == 0) return size;
  std::string bytes(reinterpret_cast<const char*>(data), size);
  format.repair(bytes);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(data));
  return bytes.size();
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    isophote::fuzz::format().read(std::string(reinterpret_cast<const char*>(data), size));
  } catch (const isophote::Error& error) {
    if (error.kind() == isophote::ErrorKind::kInternal) throw;
  }
  return 0;
}
