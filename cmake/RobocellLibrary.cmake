# librobocell: every source under src/robocell that is not a test. Folders are the layers; tests check the includes.
file(GLOB_RECURSE ROBOCELL_SOURCES CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/*.cc")
list(FILTER ROBOCELL_SOURCES EXCLUDE REGEX "_test\\.cc$|/testing/")

include(RobocellExports)

# Code that waits for disks, processes, people and the engine is optimised less: the compiler takes a quarter less time for it.
# (A library of objects, since sources with options of their own are not compiled together.)
set(ROBOCELL_WAITING_SOURCES ${ROBOCELL_SOURCES})
list(FILTER ROBOCELL_WAITING_SOURCES INCLUDE REGEX "/src/robocell/(spec|assets|media|data|scene|scenes|task|expert|rollout|diagnose|viewer)/")
list(REMOVE_ITEM ROBOCELL_SOURCES ${ROBOCELL_WAITING_SOURCES})
add_library(robocell_waiting OBJECT ${ROBOCELL_WAITING_SOURCES})
robocell_unity(robocell_waiting ${ROBOCELL_UNITY_WAITING} ${ROBOCELL_WAITING_SOURCES})
if(CMAKE_BUILD_TYPE STREQUAL "Release")
  target_compile_options(robocell_waiting PRIVATE -O1)
endif()

add_library(robocell SHARED ${ROBOCELL_SOURCES} $<TARGET_OBJECTS:robocell_waiting>)
add_library(robocell::robocell ALIAS robocell)
robocell_unity(robocell ${ROBOCELL_UNITY_FILES} ${ROBOCELL_SOURCES})
# Kernels: compiled for every instruction set, or worth the better optimisation.
foreach(kernel kinematics/lane_kernel kinematics/link_kernel kinematics/pose_kernel kinematics/start_table
               control/operational_space)
  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/${kernel}.cc" PROPERTIES
    COMPILE_OPTIONS "-O3" SKIP_UNITY_BUILD_INCLUSION ON)
endforeach()
if(ROBOCELL_SANITIZE)  # -O3 takes many times as long to compile the instrumented ones, and gains nothing that is asked for
  foreach(kernel lane_kernel pose_kernel)
    set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/kinematics/${kernel}.cc" PROPERTIES COMPILE_OPTIONS "")
  endforeach()
endif()
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/media/yuv420.cc" PROPERTIES
  COMPILE_OPTIONS "-O2" SKIP_UNITY_BUILD_INCLUSION ON)
# The same bytes with every instruction set: no multiplication and addition in one.
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/render/soft_kernel.cc"
  "${PROJECT_SOURCE_DIR}/src/robocell/motion/sphere_kernel.cc" PROPERTIES
  COMPILE_OPTIONS "-O3;-ffp-contract=off" SKIP_UNITY_BUILD_INCLUSION ON)
# The headers of ruckig are this file's alone.
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/motion/trajectory.cc" PROPERTIES
  INCLUDE_DIRECTORIES "${ROBOCELL_RUCKIG_INCLUDES}" SKIP_UNITY_BUILD_INCLUSION ON)
# ThreadSanitizer gives every function something to clean up, which an exception of the engine cannot pass
# (engine_exception.h). What it then does not tell is who called a function of these. (Tests: RobocellTests.cmake.)
set(ROBOCELL_EXCEPTIONS_PASS "--param=tsan-instrument-func-entry-exit=0")
if(ROBOCELL_SANITIZE MATCHES "thread")
  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/mujoco/compile.cc" PROPERTIES
    COMPILE_OPTIONS "${ROBOCELL_EXCEPTIONS_PASS}" SKIP_UNITY_BUILD_INCLUSION ON)
endif()
# Each guarded call looks thread-local data up. By descriptors, where the compiler knows them, that is a call of two
# instructions whenever the loader had room for the data beside the program's own.
# (The preset tidy answers for clang-tidy, which does not know them.)
include(CheckCXXCompilerFlag)
check_cxx_compiler_flag(-mtls-dialect=gnu2 ROBOCELL_HAS_TLS_DESCRIPTORS)
if(ROBOCELL_HAS_TLS_DESCRIPTORS AND NOT ROBOCELL_SANITIZE)
  set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/mujoco/guard.cc" PROPERTIES
    COMPILE_OPTIONS "-mtls-dialect=gnu2" SKIP_UNITY_BUILD_INCLUSION ON)
endif()
target_compile_features(robocell PUBLIC cxx_std_20)
# Calls within the library go straight to what they call, not through a table that others could change.
target_link_options(robocell PRIVATE ${ROBOCELL_RUCKIG_LINK_OPTIONS} "LINKER:-Bsymbolic-functions" "LINKER:--version-script=${ROBOCELL_EXPORTS}")
set_target_properties(robocell PROPERTIES LINK_DEPENDS "${ROBOCELL_EXPORTS}")
set(ROBOCELL_PUBLIC_LIBRARIES mujoco::mujoco Eigen3::Eigen fmt::fmt)
set(ROBOCELL_PRIVATE_LIBRARIES robocell_flags spdlog::spdlog yaml-cpp nlohmann_json::nlohmann_json orocos-kdl
  OpenSSL::Crypto PkgConfig::HWY ${HDF5_C_LIBRARIES} PNG::PNG Threads::Threads ${CMAKE_DL_LIBS}
  $<LINK_ONLY:ruckig::ruckig> $<LINK_ONLY:tinyxml2::tinyxml2>)  # its flags would be those of every file; its header needs none
target_include_directories(robocell PUBLIC
  "$<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/src>" "$<INSTALL_INTERFACE:include>")
target_include_directories(robocell_waiting PRIVATE "${PROJECT_SOURCE_DIR}/src")
foreach(part robocell robocell_waiting)
  target_include_directories(${part} SYSTEM PRIVATE ${HDF5_C_INCLUDE_DIRS} ${orocos_kdl_INCLUDE_DIRS}
    ${XXHASH_INCLUDE_DIR})
  target_link_libraries(${part} PUBLIC ${ROBOCELL_PUBLIC_LIBRARIES} PRIVATE ${ROBOCELL_PRIVATE_LIBRARIES})
endforeach()
# In the wheel MuJoCo's package is a neighbour; an installed library finds MuJoCo where it was when it was built.
set(ROBOCELL_INSTALL_RPATH "$ORIGIN;$ORIGIN/../mujoco")
if(NOT SKBUILD AND MUJOCO_DIR)
  list(APPEND ROBOCELL_INSTALL_RPATH "${MUJOCO_DIR}")
endif()
# Its folder stays this one within a project that collects its libraries: `models` is beside it.
set_target_properties(robocell PROPERTIES
  BUILD_RPATH "${MUJOCO_DIR}" INSTALL_RPATH "${ROBOCELL_INSTALL_RPATH}"
  LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}" VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION})
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/base/version.cc" PROPERTIES
  COMPILE_DEFINITIONS "ROBOCELL_VERSION=\"${PROJECT_VERSION}\"")

# What is preloaded into ffmpeg, so that its start is paid once (media/warm_program.h). It lies beside the library, and is
# code of no sanitizer, since ffmpeg has none.
add_library(robocell_warm_start MODULE "${PROJECT_SOURCE_DIR}/src/robocell/media/warm_start.c")
target_link_libraries(robocell_warm_start PRIVATE ${CMAKE_DL_LIBS})
if(ROBOCELL_SANITIZE)
  target_compile_options(robocell_warm_start PRIVATE -fno-sanitize=all)
  target_link_options(robocell_warm_start PRIVATE -fno-sanitize=all)
endif()
set_target_properties(robocell_warm_start PROPERTIES PREFIX "" C_VISIBILITY_PRESET hidden
  LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")
add_dependencies(robocell robocell_warm_start)

# Draws for the processes of a machine (render/drawing_service.h). It lies beside the library, which it is a call of.
add_executable(robocell_drawing_service "${PROJECT_SOURCE_DIR}/src/programs/drawing_service.cc")
target_link_libraries(robocell_drawing_service PRIVATE robocell robocell_flags)
set_target_properties(robocell_drawing_service PROPERTIES BUILD_RPATH "${MUJOCO_DIR}" BUILD_RPATH_USE_ORIGIN ON
  INSTALL_RPATH "${ROBOCELL_INSTALL_RPATH}" RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")

# The same objects, with robocell::internal shown. Tests, and benchmarks of inner parts, link to it in place of librobocell.
if(ROBOCELL_TESTS OR ROBOCELL_BENCHMARKS)
  add_library(robocell_for_tests SHARED $<TARGET_OBJECTS:robocell> $<TARGET_OBJECTS:robocell_waiting>)
  target_include_directories(robocell_for_tests PUBLIC "${PROJECT_SOURCE_DIR}/src")
  target_compile_features(robocell_for_tests PUBLIC cxx_std_20)
  target_link_libraries(robocell_for_tests PUBLIC ${ROBOCELL_PUBLIC_LIBRARIES} PRIVATE ${ROBOCELL_PRIVATE_LIBRARIES})
  target_link_options(robocell_for_tests PRIVATE ${ROBOCELL_RUCKIG_LINK_OPTIONS} "LINKER:-Bsymbolic-functions")
  set_target_properties(robocell_for_tests PROPERTIES LINKER_LANGUAGE CXX BUILD_RPATH "${MUJOCO_DIR}"
    LIBRARY_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}")
  add_dependencies(robocell_for_tests robocell_warm_start robocell_drawing_service)
endif()
