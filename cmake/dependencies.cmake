# SPDX-License-Identifier: Apache-2.0
# Every dependency is a package of the distribution (tools/packages); docs/dependencies.md says why each is used.
find_package(Threads REQUIRED)
find_package(embree 3 REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
find_package(fmt REQUIRED)
find_package(nlohmann_json 3 REQUIRED)
find_package(CLI11 REQUIRED)
find_package(OpenEXR REQUIRED)
find_package(PNG REQUIRED)
find_package(JPEG REQUIRED)
find_package(Vulkan REQUIRED)
# Debian ships volk as source: the one file that loads Vulkan defines VOLK_IMPLEMENTATION before including volk.h.
find_path(VOLK_INCLUDE_DIR volk.h REQUIRED)
find_program(GLSLC glslc REQUIRED)

find_package(glfw3 3.3 REQUIRED)
# Debian's Dear ImGui is a static library with its backends for GLFW and OpenGL inside, and stb behind it; it has no
# CMake package.
find_path(IMGUI_INCLUDE_DIR imgui.h PATH_SUFFIXES imgui REQUIRED)
find_library(IMGUI_LIBRARY imgui REQUIRED)
find_library(STB_LIBRARY stb REQUIRED)
# What the viewer's window is made of. libGL is not among it: GLFW opens it at run time.
add_library(isophote_window INTERFACE)
target_include_directories(isophote_window SYSTEM INTERFACE ${IMGUI_INCLUDE_DIR})
target_link_libraries(isophote_window INTERFACE ${IMGUI_LIBRARY} ${STB_LIBRARY} glfw ${CMAKE_DL_LIBS})

# What a program that links the library links too: cmake/isophoteConfig.cmake.in finds them again.
set(ISOPHOTE_LIBRARIES embree TBB::tbb fmt::fmt OpenEXR::OpenEXR PNG::PNG JPEG::JPEG Threads::Threads ${CMAKE_DL_LIBS})
# These and the headers that only our own code includes.
add_library(isophote_dependencies INTERFACE)
target_include_directories(isophote_dependencies SYSTEM INTERFACE
  ${VOLK_INCLUDE_DIR} ${Vulkan_INCLUDE_DIRS})
target_link_libraries(isophote_dependencies INTERFACE ${ISOPHOTE_LIBRARIES} glm::glm nlohmann_json::nlohmann_json)
