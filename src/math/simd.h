// SPDX-FileCopyrightText: The Isophote authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace isophote {

/// Instruction sets that hot loops are compiled for; all in one binary, chosen at run time.
enum class SimdLevel { kBaseline, kAvx2, kAvx512 };

/// The best level that this processor has.
SimdLevel bestSimdLevel();
std::string_view name(SimdLevel level);

}  // namespace isophote

/// Compiles one always-inlined function `body` for every instruction set and defines `nameFor(level)`, which
/// returns the one to call:
///
///   SHARED_FN void gatherBody(Tile& tile, int count) { ...loops over lanes... }
///   ISOPHOTE_SIMD(gather, gatherBody, (Tile & tile, int count), (tile, count))
///   gatherFor(bestSimdLevel())(tile, count);
///
/// The wrappers differ in their target attribute alone: GCC inlines `body` into each and vectorises it there
/// (measured: target_clones leaves the inlined loop at the baseline). No file has flags that add
/// instructions, so no inline function is ever emitted with instructions that an older processor lacks.
#define ISOPHOTE_SIMD(name, body, parameters, arguments)                                               \
  __attribute__((target("avx512f,avx512vl,avx512bw,avx512dq,avx512cd,avx2,fma,bmi,bmi2"))) inline void \
      name##Avx512 parameters {                                                                        \
    body arguments;                                                                                    \
  }                                                                                                    \
  __attribute__((target("avx2,fma,bmi,bmi2"))) inline void name##Avx2 parameters { body arguments; }   \
  inline void name##Baseline parameters { body arguments; }                                            \
  inline auto* name##For(::isophote::SimdLevel level) {                                                \
    return level == ::isophote::SimdLevel::kAvx512 ? name##Avx512                                      \
           : level == ::isophote::SimdLevel::kAvx2 ? name##Avx2                                        \
                                                   : name##Baseline;                                   \
  }
