# SPDX-License-Identifier: Apache-2.0
# Compiles every src/**/*.comp to SPIR-V with glslc and embeds it as a C++ array:
# `#include "shaders/<stem>.h"` gives `isophote::shaders::<stem>`, a span of 32-bit words.
function(isophote_shaders target)
  file(GLOB_RECURSE shaders CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/src/*.comp)
  set(out_dir ${PROJECT_BINARY_DIR}/generated/shaders)
  file(MAKE_DIRECTORY ${out_dir})
  foreach(shader ${shaders})
    get_filename_component(stem ${shader} NAME_WE)
    set(spv ${out_dir}/${stem}.spv.inc)
    set(header ${out_dir}/${stem}.h)
    add_custom_command(
      OUTPUT ${spv}
      COMMAND ${GLSLC} --target-env=vulkan1.3 -std=460 -O -g -Werror -mfmt=num -I ${PROJECT_SOURCE_DIR}/src
              -MD -MF ${spv}.d -MT ${spv} -o ${spv} ${shader}
      DEPENDS ${shader}
      DEPFILE ${spv}.d
      COMMENT "Compiling shader ${stem}.comp"
      VERBATIM)
    file(CONFIGURE OUTPUT ${header} @ONLY CONTENT
"// Generated from ${stem}.comp by cmake/shaders.cmake.
#pragma once
#include <cstdint>
#include <span>
namespace isophote::shaders {
inline constexpr std::uint32_t ${stem}Words[] = {
#include \"${stem}.spv.inc\"
};
inline constexpr std::span<const std::uint32_t> ${stem}{${stem}Words};
}  // namespace isophote::shaders
")
    target_sources(${target} PRIVATE ${spv})
  endforeach()
  target_include_directories(${target} PUBLIC ${PROJECT_BINARY_DIR}/generated)
endfunction()
