# Everything robocell links to: system packages, and MuJoCo (RobocellMujoco.cmake). Python is needed for the extension only.
if(NOT PROJECT_IS_TOP_LEVEL)
  set(CMAKE_FIND_PACKAGE_TARGETS_GLOBAL ON)  # the project around this one links to Eigen, fmt and MuJoCo too
endif()
if(ROBOCELL_PYTHON)
  set(Python_FIND_VIRTUALENV FIRST)
  find_package(Python 3.11 REQUIRED COMPONENTS Interpreter OPTIONAL_COMPONENTS Development.Module)
endif()
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

# ruckig times motions. Its Python package brings headers, a static library and its CMake config (scripts/setup installs
# it); an installed one, or ruckig_DIR, is used instead. The target's own flags switch on a client for a web service, with
# headers of other libraries: only the headers and the library are taken.
set(ruckig_hints "")
if(NOT ruckig_DIR)
  if(Python_EXECUTABLE)
    set(python "${Python_EXECUTABLE}")
  else()
    find_program(python NAMES python3 PATHS "${PROJECT_SOURCE_DIR}/.venv/bin" NO_DEFAULT_PATH NO_CACHE)
    find_program(python python3 NO_CACHE)
  endif()
  execute_process(COMMAND "${python}" -c
    "import importlib.util as u, os; s = u.find_spec('ruckig'); print(os.path.dirname(s.origin) if s else '', end='')"
    OUTPUT_VARIABLE ruckig_package ERROR_QUIET)
  if(ruckig_package)
    set(ruckig_hints HINTS "${ruckig_package}/lib64/cmake/ruckig" "${ruckig_package}/lib/cmake/ruckig")
  endif()
endif()
find_package(ruckig CONFIG QUIET ${ruckig_hints})
if(NOT ruckig_FOUND)
  message(FATAL_ERROR "ruckig not found: run scripts/setup, or `pip install ruckig` for ${python}, or set ruckig_DIR")
endif()
get_target_property(ROBOCELL_RUCKIG_INCLUDES ruckig::ruckig INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER ROBOCELL_RUCKIG_INCLUDES EXCLUDE REGEX "third_party")
# Objects that newer compilers made of <iostream> name this function, so that older libraries refuse them, and never call
# it. What else they need is in the library of g++ 12.
include(CheckCXXSourceCompiles)
check_cxx_source_compiles("namespace std { void ios_base_library_init(); } int main() { std::ios_base_library_init(); }"
  ROBOCELL_HAS_IOS_LIBRARY_INIT)
set(ROBOCELL_RUCKIG_LINK_OPTIONS "")
if(NOT ROBOCELL_HAS_IOS_LIBRARY_INIT)
  set(ROBOCELL_RUCKIG_LINK_OPTIONS "LINKER:--defsym=_ZSt21ios_base_library_initv=0")
endif()

include(RobocellMujoco)
set(ROBOCELL_MUJOCO_VERSION 4.0.0)
robocell_find_mujoco(${ROBOCELL_MUJOCO_VERSION})
if(MUJOCO_PROBLEM)
  message(FATAL_ERROR "${MUJOCO_PROBLEM}")
endif()
get_target_property(imported mujoco::mujoco IMPORTED)
if(ROBOCELL_SANITIZE MATCHES "address" AND imported)
  # mjsan.h does not compile with g++ under ASan; the library itself is not instrumented anyway.
  target_compile_options(mujoco::mujoco INTERFACE -U__SANITIZE_ADDRESS__)
endif()
