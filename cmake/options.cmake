# SPDX-License-Identifier: Apache-2.0
# Compiler options of our own code. Dependencies are SYSTEM and see no warnings.
add_library(isophote_options INTERFACE)
target_compile_options(isophote_options INTERFACE
  -Wall -Wextra -Wshadow -Wconversion -Wno-sign-conversion $<$<BOOL:${ISOPHOTE_WERROR}>:-Werror>
  # Lets loops over lanes vectorise (no errno, no traps) and gives every instruction set the same sums (no contraction).
  -fno-math-errno -fno-trapping-math -ffp-contract=off)
# GLM_FORCE_INLINE: shared functions must inline whole into the loops of each instruction set.
target_compile_definitions(isophote_options INTERFACE
  GLM_FORCE_INLINE GLM_FORCE_XYZW_ONLY VK_NO_PROTOTYPES $<$<CONFIG:Debug>:_GLIBCXX_ASSERTIONS>)
