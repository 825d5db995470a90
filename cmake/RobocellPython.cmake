# The Python extension robocell._core: one source per C++ folder. Extension and type stubs are written to python/robocell in
# the build folder, where the package of a checkout finds them (python/robocell/_build_tree.py).
file(GLOB binding_sources CONFIGURE_DEPENDS "${PROJECT_SOURCE_DIR}/python/bindings/*.cc")
if(NOT binding_sources)
  message(STATUS "python/bindings holds no sources: the Python extension is not built")
  return()
endif()
if(NOT Python_Development.Module_FOUND)
  message(FATAL_ERROR "Python's headers are missing for ${Python_EXECUTABLE}. Install them (Debian: python3-dev) "
                      "or configure with -DROBOCELL_PYTHON=OFF.")
endif()
execute_process(COMMAND "${Python_EXECUTABLE}" -m nanobind --cmake_dir
  OUTPUT_VARIABLE nanobind_ROOT OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
find_package(nanobind CONFIG REQUIRED)
# MuJoCo's package requires numpy, so that it is there.
execute_process(COMMAND "${Python_EXECUTABLE}" -c "import numpy; print(numpy.get_include())"
  OUTPUT_VARIABLE numpy_include OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)

nanobind_add_module(_core NB_STATIC ${binding_sources})
set_target_properties(nanobind-static PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 0)  # one unit: half the time
robocell_unity(_core ${ROBOCELL_UNITY_BINDINGS} ${binding_sources})
# nanobind compiles for size; not what calls of a microsecond go through.
foreach(source argument_errors arrays plain_calls plain_ik)
  set_source_files_properties("${PROJECT_SOURCE_DIR}/python/bindings/${source}.cc" PROPERTIES
    COMPILE_OPTIONS "-O2" SKIP_UNITY_BUILD_INCLUSION ON)
endforeach()
target_link_libraries(_core PRIVATE robocell orocos-kdl)
target_include_directories(_core SYSTEM PRIVATE ${orocos_kdl_INCLUDE_DIRS} "${numpy_include}")
set_target_properties(_core PROPERTIES BUILD_RPATH "${MUJOCO_DIR};${PROJECT_BINARY_DIR}"
  INSTALL_RPATH "${ROBOCELL_INSTALL_RPATH}")
set(ROBOCELL_PYTHON_DIR "${PROJECT_BINARY_DIR}/python/robocell")
set_target_properties(_core PROPERTIES LIBRARY_OUTPUT_DIRECTORY "${ROBOCELL_PYTHON_DIR}")
if(ROBOCELL_SANITIZE)  # it can only be loaded by a program that has the sanitizer, so no stubs are made from it
  return()
endif()

add_custom_command(OUTPUT "${PROJECT_BINARY_DIR}/core_stubs.stamp"
  COMMAND "${CMAKE_COMMAND}" -E env PYTHONDONTWRITEBYTECODE=1
          "${Python_EXECUTABLE}" "${PROJECT_SOURCE_DIR}/scripts/make_stubs.py" "${ROBOCELL_PYTHON_DIR}" "${ROBOCELL_PYTHON_DIR}"
  COMMAND "${CMAKE_COMMAND}" -E touch "${PROJECT_BINARY_DIR}/core_stubs.stamp"
  DEPENDS _core "${PROJECT_SOURCE_DIR}/scripts/make_stubs.py" "${PROJECT_SOURCE_DIR}/python/bindings/stubs.pat"
  COMMENT "Writing the type stubs of robocell._core" VERBATIM)
add_custom_target(_core_stubs ALL DEPENDS "${PROJECT_BINARY_DIR}/core_stubs.stamp")
