# SPDX-License-Identifier: Apache-2.0
# `cmake --install` and `cpack`: the program with its manual and completions, the library for find_package(isophote),
# the scene descriptions and the documents.
include(CMakePackageConfigHelpers)

set(manual_folder ${PROJECT_BINARY_DIR}/generated/manual)
add_custom_command(
  OUTPUT ${manual_folder}/isophote.1 ${manual_folder}/isophote.bash ${manual_folder}/_isophote
  COMMAND ${CMAKE_COMMAND} -E make_directory ${manual_folder}
  COMMAND isophote info --manual > ${manual_folder}/isophote.1
  COMMAND isophote info --completion bash > ${manual_folder}/isophote.bash
  COMMAND isophote info --completion zsh > ${manual_folder}/_isophote
  DEPENDS isophote
  COMMENT "Writing the manual and the completions from the options"
  VERBATIM)
add_custom_target(isophote_manual ALL DEPENDS ${manual_folder}/isophote.1)

install(TARGETS isophote RUNTIME)
install(TARGETS isophote_library EXPORT isophote ARCHIVE)
install(DIRECTORY include/isophote TYPE INCLUDE)
install(FILES ${manual_folder}/isophote.1 DESTINATION ${CMAKE_INSTALL_MANDIR}/man1)
install(FILES ${manual_folder}/isophote.bash DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
  RENAME isophote)
install(FILES ${manual_folder}/_isophote DESTINATION ${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions)
install(DIRECTORY scenes DESTINATION ${CMAKE_INSTALL_DATADIR}/isophote FILES_MATCHING PATTERN "*.json")
install(DIRECTORY docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES README.md CHANGELOG.md LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

set(config_folder ${CMAKE_INSTALL_LIBDIR}/cmake/isophote)
install(EXPORT isophote NAMESPACE isophote:: FILE isophoteTargets.cmake DESTINATION ${config_folder})
configure_package_config_file(cmake/isophoteConfig.cmake.in ${PROJECT_BINARY_DIR}/generated/isophoteConfig.cmake
  INSTALL_DESTINATION ${config_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/generated/isophoteConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/generated/isophoteConfig.cmake
              ${PROJECT_BINARY_DIR}/generated/isophoteConfigVersion.cmake
        DESTINATION ${config_folder})

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "The Isophote authors <authors@isophote.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Photon-mapping renderer: program and library")
set(CPACK_PACKAGE_DESCRIPTION
" Lights scenes globally (inter-reflection, caustics, colour bleeding, soft shadows,
 mirrors, glass) with photons, and path-traces them for comparison. Holds the
 program isophote and the static library for find_package(isophote).")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
# The program's own libraries are found by what it links; Vulkan is loaded at run time where present. Linking the
# library takes the headers of what it is made of.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "libvulkan1")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "libembree-dev, libtbb-dev, libfmt-dev, libopenexr-dev, libpng-dev, libjpeg-dev")
include(CPack)
