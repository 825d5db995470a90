# One test program per layer, made from every *_test.cc in its folder and those within it; new files need no change here.
find_package(GTest REQUIRED)

# What tests share: where the Menagerie is, how a test is skipped. Never part of the library.
file(GLOB testing_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/testing/*.cc")
list(FILTER testing_sources EXCLUDE REGEX "_test\\.cc$")
add_library(robocell_testing STATIC ${testing_sources})
if(ROBOCELL_SANITIZE OR NOT CMAKE_BUILD_TYPE STREQUAL "Release")
  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/testing/ratio_of_times.cc"
    PROPERTIES COMPILE_DEFINITIONS ROBOCELL_SLOW_BUILD)
endif()
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/testing/source_dir.cc"
  PROPERTIES COMPILE_DEFINITIONS "ROBOCELL_SOURCE_DIR=\"${PROJECT_SOURCE_DIR}\"")
target_link_libraries(robocell_testing PUBLIC robocell_for_tests GTest::gmock GTest::gtest
  PRIVATE robocell_flags PkgConfig::HWY)
if(CMAKE_BUILD_TYPE STREQUAL "Release")  # Eigen's decompositions: seconds less, and fast enough
  target_compile_options(robocell_testing PRIVATE -O1)
endif()

# Scene after scene takes and frees megabytes: malloc keeps them instead of giving them back, which takes a fifth of
# the time. What is in use is the same.
set(keep_memory "MALLOC_TRIM_THRESHOLD_=1000000000;MALLOC_MMAP_THRESHOLD_=1000000000")
set(slowest_layers scene rollout task expert motion scenes render robot data media env kinematics)

# clang++ takes two thirds of g++'s time for code that is not optimised, and reads the headers with other eyes. The
# library stays g++'s. CMake knows one compiler for a language, so the launcher puts the other in its place.
if(PROJECT_IS_TOP_LEVEL AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_BUILD_TYPE STREQUAL "Release")
  find_program(ROBOCELL_TEST_COMPILER clang++)
endif()
set(ROBOCELL_TEST_COMPILER "${ROBOCELL_TEST_COMPILER}" CACHE FILEPATH "Compiler of tests that are not optimised; empty: as the library")
mark_as_advanced(ROBOCELL_TEST_COMPILER)

# robocell_test_options(TARGET OPTIONS...): what tests are compiled with; the options where the build is not a debug build.
function(robocell_test_options target)
  target_include_directories(${target} SYSTEM PRIVATE ${HDF5_C_INCLUDE_DIRS} ${orocos_kdl_INCLUDE_DIRS})
  target_link_libraries(${target} PRIVATE robocell_testing robocell_flags spdlog::spdlog yaml-cpp
    nlohmann_json::nlohmann_json orocos-kdl ${HDF5_C_LIBRARIES} GTest::gmock GTest::gtest_main Threads::Threads)
  if(CMAKE_BUILD_TYPE STREQUAL "Release" OR ROBOCELL_SANITIZE)
    target_compile_options(${target} PRIVATE ${ARGN})
  endif()
endfunction()

if(ROBOCELL_TEST_COMPILER)
  set(test_launcher "${PROJECT_BINARY_DIR}/test_compiler")
  robocell_launcher("${test_launcher}"
    "shift  # g++, whose options clang does not know are ignored
# It would read the precompiled headers that it is to write anew.
for word; do case \"$word\" in *.gch) rm -f \"$word\" ;; esac; done
exec ${CCACHE_PROGRAM} \"${ROBOCELL_TEST_COMPILER}\" \"$@\" \\
  -Xclang -fno-pch-timestamp -fpch-instantiate-templates \\
  -Wno-unknown-warning-option -Wno-ignored-optimization-argument -Wno-unused-command-line-argument")
  # Headers of others that most tests include: read once, which clang++ is quick at. (The include of a test is still
  # needed: the preset debug precompiles nothing.) This program exists for that alone.
  set(test_headers "${PROJECT_BINARY_DIR}/test_headers.cc")
  file(CONFIGURE OUTPUT "${test_headers}" CONTENT "int main() {}\n")
  add_executable(test_headers EXCLUDE_FROM_ALL "${test_headers}")
  robocell_test_options(test_headers -O0)
  set_target_properties(test_headers PROPERTIES CXX_COMPILER_LAUNCHER "${test_launcher}")
  target_precompile_headers(test_headers PRIVATE <algorithm> <cmath> <filesystem> <fstream> <functional> <memory>
    <optional> <set> <string> <thread> <vector> <fmt/format.h> <gmock/gmock.h> <gtest/gtest.h> <mujoco/mujoco.h>
    <Eigen/Core> <Eigen/Geometry> <nlohmann/json.hpp>)
endif()

# robocell_test(NAME SOURCES...): a test program and its tests.
function(robocell_test name)
  add_executable(${name} ${ARGN})
  robocell_unity(${name} ${ROBOCELL_UNITY_TESTS} ${ARGN})
  # Tests wait for the library, which is optimised; optimising them costs more than it brings, but for
  # those of kinematics, which compute much themselves.
  if(ROBOCELL_SANITIZE AND name MATCHES "^(math|kinematics|control|render|threads)_test$")
    set(level -O1)  # what is instrumented runs slowly enough
  elseif(name STREQUAL "kinematics_test")
    set(level -Og)
  else()
    set(level -O0 ${ROBOCELL_FOLD_CASTS})
    if(ROBOCELL_TEST_COMPILER)
      set(level -O0)
      set_target_properties(${name} PROPERTIES CXX_COMPILER_LAUNCHER "${test_launcher}")
      target_precompile_headers(${name} REUSE_FROM test_headers)
    endif()
  endif()
  robocell_test_options(${name} ${level})
  set_target_properties(${name} PROPERTIES BUILD_RPATH "${MUJOCO_DIR}")
  string(REPLACE "_test" "" label ${name})
  # Two processes a layer: starting one for every test costs more than most tests. Those that take longest come first,
  # so that none of them is left alone at the end.
  list(FIND slowest_layers ${label} place)
  set(cost 0)
  if(place GREATER -1)
    math(EXPR cost "100 - ${place}")
  endif()
  foreach(shard 0 1)
    add_test(NAME ${name}.${shard} COMMAND ${name} --gtest_brief=1 WORKING_DIRECTORY "${PROJECT_BINARY_DIR}")
    set_tests_properties(${name}.${shard} PROPERTIES LABELS ${label} TIMEOUT 900 COST ${cost}
      ENVIRONMENT "GTEST_TOTAL_SHARDS=2;GTEST_SHARD_INDEX=${shard};${keep_memory}")
  endforeach()
endfunction()

file(GLOB layers RELATIVE "${PROJECT_SOURCE_DIR}/src/robocell" CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/*")
foreach(layer ${layers})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/${layer}/*_test.cc")
  if(sources)
    robocell_test(${layer}_test ${sources})
  endif()
endforeach()

if(ROBOCELL_SANITIZE MATCHES "thread")
  target_compile_options(mujoco_test PRIVATE "${ROBOCELL_EXCEPTIONS_PASS}")
endif()

# Across layers: what may happen in several threads at once (make check-tsan).
robocell_test(threads_test "${PROJECT_SOURCE_DIR}/tests/threads/threads_test.cc")

# For tests/reliability: a program that keeps a ledger of what it wrote, and the disks under it.
if(NOT ROBOCELL_SANITIZE)
  add_executable(write_ledger "${PROJECT_SOURCE_DIR}/tests/reliability/write_ledger.cc")
  target_link_libraries(write_ledger PRIVATE robocell robocell_flags)
  set_target_properties(write_ledger PROPERTIES BUILD_RPATH "${MUJOCO_DIR}")
  add_library(fault_io MODULE "${PROJECT_SOURCE_DIR}/tests/reliability/fault_io.c")
  add_library(network_locks MODULE "${PROJECT_SOURCE_DIR}/tests/reliability/network_locks.c")
  add_library(no_graphics MODULE "${PROJECT_SOURCE_DIR}/tests/reliability/no_graphics.c")
  foreach(shim record_io odd_clock many_processors)
    add_library(${shim} MODULE "${PROJECT_SOURCE_DIR}/tests/reliability/${shim}.c")
  endforeach()
  foreach(shim fault_io network_locks no_graphics record_io odd_clock many_processors)
    target_link_libraries(${shim} PRIVATE ${CMAKE_DL_LIBS})
  endforeach()
endif()
