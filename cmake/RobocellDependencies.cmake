# Everything robocell links to: system packages, and MuJoCo from the Python wheel of the active environment.
set(Python_FIND_VIRTUALENV FIRST)
find_package(Python 3.11 REQUIRED COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(fmt REQUIRED)
find_package(spdlog REQUIRED)
find_package(yaml-cpp REQUIRED)
if(NOT TARGET yaml-cpp)  # 0.8 (Ubuntu 24.04) knows the target under its namespace only
  add_library(yaml-cpp INTERFACE IMPORTED)
  target_link_libraries(yaml-cpp INTERFACE yaml-cpp::yaml-cpp)
endif()
find_package(nlohmann_json REQUIRED)
find_package(tinyxml2 REQUIRED)
find_package(orocos_kdl REQUIRED)
find_package(OpenSSL REQUIRED COMPONENTS Crypto)
find_package(HDF5 REQUIRED COMPONENTS C)
find_package(PNG REQUIRED)
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)  # the header alone is used
find_package(PkgConfig REQUIRED)
pkg_check_modules(HWY REQUIRED IMPORTED_TARGET libhwy)
find_package(Threads REQUIRED)

set(ROBOCELL_MUJOCO_VERSION 4.0.0)
execute_process(
  COMMAND "${Python_EXECUTABLE}" -c
          "import importlib.util as u, os; print(os.path.dirname(u.find_spec('mujoco').origin))"
  OUTPUT_VARIABLE MUJOCO_DIR OUTPUT_STRIP_TRAILING_WHITESPACE COMMAND_ERROR_IS_FATAL ANY)
set(MUJOCO_LIBRARY "${MUJOCO_DIR}/libmujoco.so.${ROBOCELL_MUJOCO_VERSION}")
if(NOT EXISTS "${MUJOCO_LIBRARY}")
  message(FATAL_ERROR "robocell needs mujoco ${ROBOCELL_MUJOCO_VERSION}, but ${MUJOCO_LIBRARY} does not exist. "
                      "Install it: pip install mujoco==${ROBOCELL_MUJOCO_VERSION}")
endif()
add_library(mujoco::mujoco SHARED IMPORTED)
set_target_properties(mujoco::mujoco PROPERTIES
  IMPORTED_LOCATION "${MUJOCO_LIBRARY}"
  IMPORTED_SONAME "libmujoco.so.${ROBOCELL_MUJOCO_VERSION}")
target_include_directories(mujoco::mujoco SYSTEM INTERFACE "${MUJOCO_DIR}/include")
if(ROBOCELL_SANITIZE MATCHES "address")
  # mjsan.h does not compile with g++ under ASan; the library itself is not instrumented anyway.
  target_compile_options(mujoco::mujoco INTERFACE -U__SANITIZE_ADDRESS__)
endif()
