# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# What `cmake --install` and `cpack -G DEB` put where, beside the programs and libraries themselves.
include(CMakePackageConfigHelpers)

# The programs find configurations by name in share/engram beside their own folder: in the build tree, those of config/.
file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/share)
file(CREATE_LINK ${PROJECT_SOURCE_DIR}/config ${CMAKE_BINARY_DIR}/share/engram SYMBOLIC)

# Installed, the calibrations lie in a folder below the configurations.
file(GLOB configs CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/config/*.ini)
foreach(config ${configs})
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${config})
  cmake_path(GET config FILENAME name)
  file(READ ${config} text)
  string(REPLACE "file = ../share/cameras/" "file = cameras/" text "${text}")
  string(REPLACE "config/${name}" "${name}" text "${text}")
  file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/installed_config/${name} CONTENT "${text}" @ONLY)
endforeach()
install(DIRECTORY ${PROJECT_BINARY_DIR}/installed_config/ ${PROJECT_SOURCE_DIR}/share/cameras
        DESTINATION ${CMAKE_INSTALL_DATADIR}/engram COMPONENT programs FILES_MATCHING PATTERN *.ini)
# The pages find each other as in the sources.
install(FILES README.md CHANGELOG.md CONTRIBUTING.md LICENSE TYPE DOC COMPONENT programs)
install(DIRECTORY docs examples TYPE DOC COMPONENT programs)
install(DIRECTORY share/figures DESTINATION ${CMAKE_INSTALL_DOCDIR}/share COMPONENT programs)

# engramConfig.cmake, for find_package(engram).
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/engram)
configure_package_config_file(cmake/engramConfig.cmake.in ${PROJECT_BINARY_DIR}/engramConfig.cmake
                              INSTALL_DESTINATION ${package_folder})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/engramConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/engramConfig.cmake ${PROJECT_BINARY_DIR}/engramConfigVersion.cmake
        DESTINATION ${package_folder} COMPONENT development)
install(EXPORT engramTargets NAMESPACE engram:: DESTINATION ${package_folder} COMPONENT development)

# Completion and man pages: both from what the programs say of themselves.
get_property(programs GLOBAL PROPERTY ENGRAM_PROGRAMS)
find_program(HELP2MAN help2man)
foreach(program ${programs})
  install(FILES share/completion/engram DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          RENAME engram-${program} COMPONENT programs)
  if(HELP2MAN AND PROJECT_IS_TOP_LEVEL AND NOT ENGRAM_SANITIZE)
    set(page ${PROJECT_BINARY_DIR}/man/engram-${program}.1)
    add_custom_command(OUTPUT ${page} DEPENDS engram-${program} VERBATIM
      COMMAND ${HELP2MAN} --no-info --locale=C.UTF-8 --help-option=--help-all --source=Engram
              --version-string=${PROJECT_VERSION} --name=${PROJECT_DESCRIPTION}
              --output=${page} $<TARGET_FILE:engram-${program}>)
    list(APPEND pages ${page})
  endif()
endforeach()
set(targets engram_gige_camera)
foreach(program ${programs})
  list(APPEND targets engram-${program})
endforeach()
add_custom_target(engram_programs DEPENDS ${targets} ${pages})
if(pages)
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/man)
  add_custom_target(engram_man ALL DEPENDS ${pages})
  install(FILES ${pages} DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT programs)
endif()

if(PROJECT_IS_TOP_LEVEL)
  set(CPACK_GENERATOR DEB)
  set(CPACK_PACKAGE_VENDOR "The Engram authors")
  set(CPACK_PACKAGE_CONTACT "The Engram authors <engram@localhost>")
  set(CPACK_RESOURCE_FILE_LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
  set(CPACK_COMPONENTS_ALL programs development)
  set(CPACK_DEB_COMPONENT_INSTALL ON)
  set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
  set(CPACK_STRIP_FILES ON)
  set(CPACK_DEBIAN_PACKAGE_SECTION science)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME engram)
  set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_NAME libengram-dev)
  set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_DEPENDS "libmrpt-dev, libopencv-dev, libeigen3-dev, libceres-dev, \
libsqlite3-dev, zlib1g-dev, libdeflate-dev, libzstd-dev, liblz4-dev, libbz2-dev, libjpeg-dev, nlohmann-json3-dev, libaravis-dev, libglfw3-dev, libpqxx-dev, pkg-config")
  set(CPACK_COMPONENT_PROGRAMS_DESCRIPTION "${PROJECT_DESCRIPTION}: the programs")
  set(CPACK_COMPONENT_DEVELOPMENT_DESCRIPTION "${PROJECT_DESCRIPTION}: libraries and headers")
  include(CPack)
endif()
