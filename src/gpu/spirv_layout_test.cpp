// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#include "gpu/spirv_layout.h"

#include "base/error.h"

#include <gtest/gtest.h>

namespace isophote {
namespace {

// A module by hand, as the SPIR-V specification packs it: the low half of a word is the opcode, the high half
// its words.
constexpr std::uint32_t instruction(std::uint32_t op, std::uint32_t words) { return words << 16 | op; }
constexpr std::uint32_t fourLetters(const char (&text)[5]) {
  return std::uint32_t(text[0]) | std::uint32_t(text[1]) << 8 | std::uint32_t(text[2]) << 16 |
         std::uint32_t(text[3]) << 24;
}

constexpr std::uint32_t kOpName = 5, kOpMemberName = 6, kOpTypeRuntimeArray = 29, kOpDecorate = 71,
                        kOpMemberDecorate = 72;
constexpr std::uint32_t kDecorationArrayStride = 6, kDecorationOffset = 35;

std::vector<std::uint32_t> module() {
  return {0x07230203, 0x00010600, 0, 100, 0,
          // struct 10 "Cell" with members "size" at 0 and "next" at 12
          instruction(kOpName, 4), 10, fourLetters("Cell"), 0,              //
          instruction(kOpMemberName, 5), 10, 0, fourLetters("size"), 0,     //
          instruction(kOpMemberName, 5), 10, 1, fourLetters("next"), 0,     //
          instruction(kOpMemberDecorate, 5), 10, 0, kDecorationOffset, 0,   //
          instruction(kOpMemberDecorate, 5), 10, 1, kDecorationOffset, 12,  //
          // an array of it
          instruction(kOpDecorate, 4), 11, kDecorationArrayStride, 16,  //
          instruction(kOpTypeRuntimeArray, 3), 11, 10,                  //
          // struct 12, also "Cell", without offsets: a variable of a function
          instruction(kOpName, 4), 12, fourLetters("Cell"), 0,  //
          instruction(kOpMemberName, 5), 12, 0, fourLetters("size"), 0};
}

TEST(ReadSpirv, FindsOffsetsAndStride) {
  const SpirvInterface found = readSpirv("module", module());
  ASSERT_EQ(found.structs.size(), 1u);
  EXPECT_EQ(found.structs[0].name, "Cell");
  EXPECT_EQ(found.structs[0].offsets, (std::map<std::string, std::uint32_t>{{"size", 0}, {"next", 12}}));
  EXPECT_EQ(found.structs[0].arrayStride, 16u);
  EXPECT_TRUE(found.bindings.empty());
  EXPECT_FALSE(found.pushConstants);
}

TEST(ReadSpirv, RefusesWhatIsNoModule) {
  EXPECT_THROW(readSpirv("nothing", {}), Error);
  std::vector<std::uint32_t> words = module();
  words[0] = 0xdeadbeef;
  EXPECT_THROW(readSpirv("other magic", words), Error);
}

TEST(ReadSpirv, RefusesBrokenInstructions) {
  std::vector<std::uint32_t> zeroLength = module();
  zeroLength[5] = instruction(kOpName, 0);
  EXPECT_THROW(readSpirv("zero length", zeroLength), Error);
  std::vector<std::uint32_t> tooShort = module();
  tooShort[5] = instruction(kOpName, 2);
  EXPECT_THROW(readSpirv("too short", tooShort), Error);
  std::vector<std::uint32_t> truncated = module();
  truncated.pop_back();
  EXPECT_THROW(readSpirv("truncated", truncated), Error);
}

}  // namespace
}  // namespace isophote
