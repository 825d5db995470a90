# Each examples/NN_name.cc becomes a program that is also a test: it writes into the folder it is given and fails
# when something is not as it says. tests/integration/test_examples.py runs it and compares what it prints with its
# Python twin; ctest runs it where there is no Python.
file(GLOB examples CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/examples/*.cc")
# They wait for the library, which is optimised. ccache wants the last.
set(example_options "$<$<CONFIG:Release>:-O0>" "${ROBOCELL_FOLD_CASTS}" "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>")
# All include the same header, which is most of their time: it is read once. This program exists for that alone.
set(example_headers "${PROJECT_BINARY_DIR}/example_headers.cc")
file(CONFIGURE OUTPUT "${example_headers}" CONTENT "int main() {}\n")
add_executable(example_headers EXCLUDE_FROM_ALL "${example_headers}")
target_link_libraries(example_headers PRIVATE robocell robocell_flags)
target_compile_options(example_headers PRIVATE ${example_options})
target_precompile_headers(example_headers PRIVATE "${PROJECT_SOURCE_DIR}/src/robocell/robocell.h" <fmt/format.h>)
foreach(source ${examples})
  get_filename_component(name "${source}" NAME_WE)
  add_executable(example_${name} "${source}")
  target_link_libraries(example_${name} PRIVATE robocell robocell_flags)
  target_compile_options(example_${name} PRIVATE ${example_options})
  target_precompile_headers(example_${name} REUSE_FROM example_headers)
  target_compile_definitions(example_${name} PRIVATE EXAMPLES_DIR="${PROJECT_SOURCE_DIR}/examples")
  set_target_properties(example_${name} PROPERTIES BUILD_RPATH "${MUJOCO_DIR}")
  if(ROBOCELL_TESTS AND NOT ROBOCELL_PYTHON)
    add_test(NAME example_${name} COMMAND example_${name} "${PROJECT_BINARY_DIR}/examples/${name}")
    set_tests_properties(example_${name} PROPERTIES LABELS examples TIMEOUT 300 SKIP_RETURN_CODE 77)
  endif()
endforeach()
