# tests/fuzz/*_fuzz.cc, one libFuzzer program each, with the layers that read what strangers wrote. Clang only.
if(NOT CMAKE_CXX_COMPILER_ID MATCHES "Clang")
  message(FATAL_ERROR "libFuzzer comes with clang: configure with the preset `fuzz`, or -DCMAKE_CXX_COMPILER=clang++")
endif()
foreach(layer base math spec media data)
  file(GLOB layer_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/${layer}/*.cc")
  list(APPEND fuzzed_sources ${layer_sources})
endforeach()
# Where models are found. What reads them, model_files.cc and lfs_pointers.cc, needs the engine's layer.
file(GLOB asset_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/src/robocell/assets/*.cc")
list(FILTER asset_sources EXCLUDE REGEX "/(model_files|lfs_pointers)\\.cc$")
list(APPEND fuzzed_sources ${asset_sources})
list(FILTER fuzzed_sources EXCLUDE REGEX "_test\\.cc$")
list(APPEND fuzzed_sources "${PROJECT_SOURCE_DIR}/tests/fuzz/kinds.cc")

set(fuzz_flags -fsanitize=address,undefined -fno-sanitize-recover=all -fno-omit-frame-pointer -g1 -O1
  -Wno-unknown-warning-option)
add_library(robocell_fuzzed STATIC ${fuzzed_sources})
# It includes itself for every instruction set.
set_source_files_properties("${PROJECT_SOURCE_DIR}/src/robocell/media/yuv420.cc" PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
robocell_unity(robocell_fuzzed ${ROBOCELL_UNITY_WAITING} ${fuzzed_sources})
target_compile_options(robocell_fuzzed PUBLIC ${fuzz_flags} PRIVATE -fsanitize=fuzzer-no-link)
target_include_directories(robocell_fuzzed PUBLIC "${PROJECT_SOURCE_DIR}/src" SYSTEM PRIVATE ${HDF5_C_INCLUDE_DIRS}
  ${XXHASH_INCLUDE_DIR})
target_link_libraries(robocell_fuzzed PUBLIC robocell_flags Eigen3::Eigen fmt::fmt spdlog::spdlog tinyxml2::tinyxml2 yaml-cpp
  nlohmann_json::nlohmann_json OpenSSL::Crypto PkgConfig::HWY ${HDF5_C_LIBRARIES} PNG::PNG Threads::Threads)
target_compile_definitions(robocell_fuzzed PRIVATE ROBOCELL_VERSION="${PROJECT_VERSION}")

file(GLOB fuzzers CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/tests/fuzz/*_fuzz.cc")
foreach(source ${fuzzers})
  get_filename_component(name "${source}" NAME_WE)
  add_executable(${name} "${source}")
  target_link_libraries(${name} PRIVATE robocell_fuzzed)
  target_compile_options(${name} PRIVATE -fsanitize=fuzzer)
  target_link_options(${name} PRIVATE -fsanitize=fuzzer,address,undefined)
endforeach()
