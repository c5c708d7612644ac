# SPDX-FileCopyrightText: 2026 The Engram authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Installs into a prefix, moves it elsewhere, and uses it as a stranger would: a world, a map by the name of a
# configuration, completion, and the example built through find_package.
#   cmake -DROOT=<sources> -DBUILD=<build tree> -DWORK=<folder to use> -P install_test.cmake
file(REMOVE_RECURSE ${WORK})
file(MAKE_DIRECTORY ${WORK}/home/.config/engram)
set(ENV{XDG_CONFIG_HOME} "")
set(ENV{HOME} ${WORK}/home)

# run(COMMAND …): runs it in WORK, an error unless it ends well; leaves its output in `out`.
function(run)
  execute_process(COMMAND ${ARGN} WORKING_DIRECTORY ${WORK} RESULT_VARIABLE code OUTPUT_VARIABLE text
                  ERROR_VARIABLE text)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${code}:\n${text}")
  endif()
  set(out "${text}" PARENT_SCOPE)
endfunction()
function(expect what)
  if(NOT out MATCHES "${what}")
    message(FATAL_ERROR "expected '${what}' in:\n${out}")
  endif()
endfunction()

run(${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/first)
file(RENAME ${WORK}/first ${WORK}/moved)
set(bin ${WORK}/moved/bin)
foreach(program capture eval localize map rawlog slam world)
  run(${bin}/engram-${program} --version)
  expect("^engram-${program} .Engram. [0-9]+[.][0-9]+[.][0-9]+")
endforeach()

run(${bin}/engram-world make --preset tiny --set drive.spacing=2 --sessions 1 -q --out ${WORK}/world)
run(${bin}/engram-slam fsh_omni --rawlog ${WORK}/world/session_01.rawlog --map ${WORK}/tiny.engram)
expect("new places")
run(${bin}/engram-localize --map ${WORK}/tiny.engram --rawlog ${WORK}/world/session_01.rawlog)
expect("accepted")
run(${bin}/engram-map config ${WORK}/tiny.engram)
expect("file = ${WORK}/moved/share/engram/cameras/omni_world.ini")
file(WRITE ${WORK}/home/.config/engram/mine.ini "[camera]\nfile = ../../my_camera.ini\n")
file(COPY_FILE ${WORK}/moved/share/engram/cameras/omni_world.ini ${WORK}/home/my_camera.ini)
run(${bin}/engram-slam mine --dump-config)
expect("file = ${WORK}/home/my_camera.ini")

run(bash ${CMAKE_CURRENT_LIST_DIR}/completion_test.sh ${WORK}/moved)
expect("^fsh_omni\n--overwrite-record\ninfo\n--json\n")

run(${CMAKE_COMMAND} -S ${ROOT}/examples -B ${WORK}/example -DCMAKE_BUILD_TYPE=Release
    -DCMAKE_PREFIX_PATH=${WORK}/moved)
run(${CMAKE_COMMAND} --build ${WORK}/example)
run(${WORK}/example/localise ${WORK}/tiny.engram ${WORK}/world/session_01.rawlog)
expect("recognised, place [0-9]+ with [0-9.]+, at +-?[0-9.]+ +-?[0-9.]+ m")

# As a part of another project Engram builds no tests.
file(WRITE ${WORK}/super/CMakeLists.txt
     "cmake_minimum_required(VERSION 3.25)\nproject(super LANGUAGES CXX C)\nadd_subdirectory(${ROOT} engram)\n")
run(${CMAKE_COMMAND} -S ${WORK}/super -B ${WORK}/super/build)
run(${CMAKE_COMMAND} --build ${WORK}/super/build --target help)
expect("engram-slam")
if(out MATCHES "_test")
  message(FATAL_ERROR "a subproject has tests:\n${out}")
endif()
file(REMOVE_RECURSE ${WORK})
