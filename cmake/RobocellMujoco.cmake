# robocell_find_mujoco(VERSION PLACES...) makes the target mujoco::mujoco of exactly that version. The build uses it, and
# robocellConfig.cmake for C++ users. The first of these that there is wins:
#   1. a target mujoco::mujoco that the project has already
#   2. MUJOCO_ROOT, a CMake or an environment variable: MuJoCo's release archive unpacked, an install, or the folder of
#      the Python package. When it is set, nothing else is tried.
#   3. PLACES, folders that the caller knows
#   4. find_package(mujoco)
#   5. the Python package mujoco of Python_EXECUTABLE, or else of the first python3 on the PATH
#
# Sets in the caller's scope MUJOCO_DIR, the folder of the library ("" for a library that the project itself builds), and
# MUJOCO_PROBLEM, "" or why there is no target.

# Makes the target from a folder, if it holds the library and the headers. Sets `looked` in the caller's scope.
macro(_robocell_mujoco_from folder)
  foreach(below "" /lib /lib64 "/lib/${CMAKE_LIBRARY_ARCHITECTURE}")
    set(file "${folder}${below}/libmujoco.so.${version}")
    if(NOT TARGET mujoco::mujoco AND EXISTS "${file}" AND EXISTS "${folder}/include/mujoco/mujoco.h")
      add_library(mujoco::mujoco SHARED IMPORTED GLOBAL)
      set_target_properties(mujoco::mujoco PROPERTIES
        IMPORTED_LOCATION "${file}" IMPORTED_SONAME "libmujoco.so.${version}"
        INTERFACE_INCLUDE_DIRECTORIES "${folder}/include")
    endif()
  endforeach()
  list(APPEND looked "${folder}")
endmacro()

# The folder of the Python package mujoco, "" without one.
function(_robocell_mujoco_package out)
  if(Python_EXECUTABLE)
    set(python "${Python_EXECUTABLE}")
  else()
    find_program(python python3 NO_CACHE)
  endif()
  set(folder "")
  if(python)
    execute_process(COMMAND "${python}" -c
      "import importlib.util as u, os; s = u.find_spec('mujoco'); print(os.path.dirname(s.origin) if s else '', end='')"
      OUTPUT_VARIABLE folder ERROR_QUIET)
  endif()
  set(${out} "${folder}" PARENT_SCOPE)
endfunction()

# Where the library of the target is, as far as that is known before the build.
function(_robocell_mujoco_dir out)
  set(folder "")
  get_target_property(imported mujoco::mujoco IMPORTED)
  if(imported)
    get_target_property(configurations mujoco::mujoco IMPORTED_CONFIGURATIONS)
    foreach(suffix "" ${configurations})
      string(REGEX REPLACE "^(.+)$" "_\\1" suffix "${suffix}")
      get_target_property(file mujoco::mujoco "IMPORTED_LOCATION${suffix}")
      if(file AND NOT folder)
        cmake_path(GET file PARENT_PATH folder)
      endif()
    endforeach()
  endif()
  set(${out} "${folder}" PARENT_SCOPE)
endfunction()

function(robocell_find_mujoco version)
  set(looked "")
  set(root "${MUJOCO_ROOT}")
  if(NOT root)
    set(root "$ENV{MUJOCO_ROOT}")
  endif()
  if(TARGET mujoco::mujoco)
    # The project's own.
  elseif(root)
    cmake_path(ABSOLUTE_PATH root BASE_DIRECTORY "${CMAKE_SOURCE_DIR}" NORMALIZE)
    _robocell_mujoco_from("${root}")
  else()
    foreach(place ${ARGN})
      _robocell_mujoco_from("${place}")
    endforeach()
    if(NOT TARGET mujoco::mujoco)
      find_package(mujoco ${version} EXACT CONFIG QUIET GLOBAL)
      list(APPEND looked "find_package(mujoco)")
    endif()
    if(NOT TARGET mujoco::mujoco)
      _robocell_mujoco_package(package)
      if(package)
        _robocell_mujoco_from("${package}")
      else()
        list(APPEND looked "the Python package mujoco (none found)")
      endif()
    endif()
  endif()

  set(MUJOCO_DIR "" PARENT_SCOPE)
  set(MUJOCO_PROBLEM "" PARENT_SCOPE)
  if(TARGET mujoco::mujoco)
    _robocell_mujoco_dir(folder)
    set(MUJOCO_DIR "${folder}" PARENT_SCOPE)
  elseif(root)
    set(MUJOCO_PROBLEM "MUJOCO_ROOT is ${root}, which holds no MuJoCo ${version}: \
lib/libmujoco.so.${version} (or libmujoco.so.${version} itself) and include/mujoco/mujoco.h. Unpack MuJoCo's release \
${version} there, or unset MUJOCO_ROOT to use find_package(mujoco) or the Python package." PARENT_SCOPE)
  else()
    list(JOIN looked ", " looked)
    set(MUJOCO_PROBLEM "MuJoCo ${version} not found. Looked in: ${looked}. Set MUJOCO_ROOT to its folder, or install \
the Python package: pip install mujoco==${version}" PARENT_SCOPE)
  endif()
endfunction()
