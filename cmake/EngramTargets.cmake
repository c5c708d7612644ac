# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# The only three ways to make a target in this project, and a check of their lists.

# engram_require_all_listed(PARENT NAME …): an error for a folder of PARENT with a CMakeLists.txt that no NAME names.
# That a NAME without such a folder is an error is what add_subdirectory() is for.
function(engram_require_all_listed parent)
  file(GLOB found RELATIVE ${PROJECT_SOURCE_DIR}/${parent} ${PROJECT_SOURCE_DIR}/${parent}/*/CMakeLists.txt)
  foreach(file ${found})
    get_filename_component(folder ${file} DIRECTORY)
    if(NOT folder IN_LIST ARGN)
      message(SEND_ERROR "${parent}/${folder} is not in the list of ${parent}: add it, or remove the folder")
    endif()
  endforeach()
endfunction()

# Settings that every target of ours gets, and no target of others sees.
function(engram_target_defaults target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF POSITION_INDEPENDENT_CODE ON)
  # Headers of std, Eigen and OpenCV cost most of the time: a few sources of a target share them. Names in unnamed
  # namespaces must therefore be unique within a target.
  set_target_properties(${target} PROPERTIES UNITY_BUILD ${ENGRAM_UNITY} UNITY_BUILD_BATCH_SIZE 6)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Woverloaded-virtual)
  if(ENGRAM_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # GCC 12 sees overlaps and overflows in inlined std::string and std::vector where there are none (its bug 105651).
      target_compile_options(${target} PRIVATE -Wno-error=restrict -Wno-error=array-bounds -Wno-error=stringop-overflow)
    endif()
  endif()
  if(ENGRAM_SANITIZE)
    target_compile_options(${target} PUBLIC -fsanitize=${ENGRAM_SANITIZE} -fno-omit-frame-pointer
      -fno-sanitize-recover=undefined)
    target_link_options(${target} PUBLIC -fsanitize=${ENGRAM_SANITIZE})
  endif()
  if(ENGRAM_FUZZ)
    target_compile_options(${target} PUBLIC -fsanitize=fuzzer-no-link)
  endif()
endfunction()

# engram_library(NAME SOURCES a.cpp … [PUBLIC libs …] [PRIVATE libs …]): the static library engram::NAME of libs/NAME.
function(engram_library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;PUBLIC;PRIVATE" ${ARGN})
  add_library(engram_${name} STATIC ${ARG_SOURCES})
  add_library(engram::${name} ALIAS engram_${name})
  engram_target_defaults(engram_${name})
  target_include_directories(engram_${name} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                                                   $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
                                            PRIVATE ${CMAKE_CURRENT_SOURCE_DIR}/src)
  target_link_libraries(engram_${name} PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE})
  set_target_properties(engram_${name} PROPERTIES EXPORT_NAME ${name})
  install(TARGETS engram_${name} EXPORT engramTargets ARCHIVE COMPONENT development)
  install(DIRECTORY include/ TYPE INCLUDE COMPONENT development)
endfunction()

# engram_program(NAME SOURCES main.cpp … LIBS libs …): the program engram-NAME.
function(engram_program name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBS" ${ARGN})
  add_executable(engram-${name} ${ARG_SOURCES})
  engram_target_defaults(engram-${name})
  target_link_libraries(engram-${name} PRIVATE ${ARG_LIBS})
  set_target_properties(engram-${name} PROPERTIES RUNTIME_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/bin)
  install(TARGETS engram-${name} RUNTIME COMPONENT programs)
  set_property(GLOBAL APPEND PROPERTY ENGRAM_PROGRAMS ${name})
endfunction()

# engram_test(NAME SOURCES a_test.cpp … LIBS libs … [LABELS l …] [TIMEOUT s]): one GoogleTest binary, one ctest entry.
# Label `readers`: a test of what reads files of others. test.sh runs these a second time under sanitizers.
function(engram_test name)
  cmake_parse_arguments(ARG "" "TIMEOUT" "SOURCES;LIBS;LABELS" ${ARGN})
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  if(ENGRAM_SANITIZE)
    math(EXPR ARG_TIMEOUT "3 * ${ARG_TIMEOUT}")
  endif()
  add_executable(${name}_test ${ARG_SOURCES})
  engram_target_defaults(${name}_test)
  target_link_libraries(${name}_test PRIVATE ${ARG_LIBS} GTest::gmock GTest::gtest_main)
  # Tests see the private headers of the library whose folder they share.
  cmake_path(GET CMAKE_CURRENT_SOURCE_DIR FILENAME library)
  if(TARGET engram_${library})
    target_include_directories(${name}_test PRIVATE ${PROJECT_SOURCE_DIR}/libs/${library}/src)
  endif()
  target_compile_definitions(${name}_test PRIVATE
    ENGRAM_SOURCE_DIR="${PROJECT_SOURCE_DIR}" ENGRAM_BIN_DIR="${CMAKE_BINARY_DIR}/bin")
  add_test(NAME ${name} COMMAND ${name}_test)
  set_tests_properties(${name} PROPERTIES TIMEOUT ${ARG_TIMEOUT} LABELS "${ARG_LABELS}")
  if("readers" IN_LIST ARG_LABELS)
    set_property(GLOBAL APPEND PROPERTY ENGRAM_READER_TESTS ${name}_test)
  endif()
endfunction()
