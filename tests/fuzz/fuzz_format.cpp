// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
//
// The only part that differs between the programs.
namespace isophote::fuzz {

extern const char* const kFuzzFormat;
const char* const kFuzzFormat = ISOPHOTE_FUZZ_FORMAT;

}  // namespace isophote::fuzz
