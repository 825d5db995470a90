# benchmarks/*_bench.cc, one program each, on google-benchmark.
find_package(benchmark REQUIRED)
file(GLOB benches CONFIGURE_DEPENDS "${CMAKE_SOURCE_DIR}/benchmarks/*_bench.cc")
foreach(source ${benches})
  get_filename_component(name "${source}" NAME_WE)
  add_executable(${name} "${source}")
  target_link_libraries(${name} PRIVATE robocell robocell_flags benchmark::benchmark)
  set_target_properties(${name} PROPERTIES BUILD_RPATH "${MUJOCO_DIR}")
endforeach()
