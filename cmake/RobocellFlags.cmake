# Compiler settings shared by everything we build.
set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

# Within another project, that project's build type and options are used.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
  endif()
  # -O2: -O3 doubles some compile times and gains nothing measurable outside the SIMD kernels, which set their own.
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
  set(CMAKE_C_FLAGS_RELEASE "-O2 -DNDEBUG")
endif()

# g++ collects its garbage early unless told that there is memory: a tenth of the build's time for 60 MB a process.
add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,GNU>:SHELL:--param ggc-min-heapsize=1000000>")

# For what is not optimised: without it each std::move is a function to compile and to call.
# (The preset tidy answers for clang-tidy, which does not know it.)
set(ROBOCELL_FOLD_CASTS "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-ffold-simple-inlines>" CACHE STRING "")
mark_as_advanced(ROBOCELL_FOLD_CASTS)

# Files of one folder are compiled several at a time, which takes less than half the time of a whole build: they share
# the same headers and the same templates. So names in anonymous namespaces are unique within a layer.
option(ROBOCELL_UNITY "Compile several sources of a layer together" ON)
# More would make the build after one change slow: 15 to 20 seconds a unit are the most.
set(ROBOCELL_UNITY_FILES 16)
set(ROBOCELL_UNITY_WAITING 20)  # optimised less
set(ROBOCELL_UNITY_TESTS 24)  # not optimised: headers are most of their time
set(ROBOCELL_UNITY_BINDINGS 8)  # nanobind's templates are many

# robocell_unity(TARGET MOST SOURCES...): groups of at most that many sources and of about the same size, never across
# folders. Sources with options of their own, or with SKIP_UNITY_BUILD_INCLUSION, stay alone.
function(robocell_unity target most)
  if(NOT ROBOCELL_UNITY)
    return()
  endif()
  # It takes the files compiled together for headers, whose anonymous namespaces would be a mistake.
  target_compile_options(${target} PRIVATE "$<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>")
  # At the end of the configuration, when sources have the properties that are set after this call.
  cmake_language(EVAL CODE "cmake_language(DEFER CALL robocell_units [[${target}]] [[${most}]] [[${ARGN}]])")
endfunction()

# CMake's own units name their sources by whole paths, so that ccache would see other texts in another checkout: these
# name them from the include folder, or from where the unit lies.
function(robocell_units target most every)
  set(place "${PROJECT_BINARY_DIR}/Unity/${target}")
  set(includes "${PROJECT_SOURCE_DIR}/src")
  # The way up from a build folder that is a link leads elsewhere: whole paths, then.
  file(REAL_PATH "${PROJECT_SOURCE_DIR}" real_source)
  file(REAL_PATH "${PROJECT_BINARY_DIR}" real_build)
  cmake_path(RELATIVE_PATH real_build BASE_DIRECTORY "${real_source}")
  cmake_path(RELATIVE_PATH PROJECT_BINARY_DIR BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE build)
  set(units "")
  set(folders "")
  foreach(source ${every})
    cmake_path(GET source PARENT_PATH folder)
    list(APPEND folders "${folder}")
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder ${folders})
    set(sources "")
    foreach(source ${every})
      cmake_path(GET source PARENT_PATH of)
      if(of STREQUAL folder)
        list(APPEND sources "${source}")
      endif()
    endforeach()
    list(SORT sources)
    cmake_path(GET folder FILENAME layer)
    list(LENGTH sources count)
    math(EXPR groups "(${count} + ${most} - 1) / ${most}")
    set(number 0)
    foreach(source ${sources})
      math(EXPR group "${number} * ${groups} / ${count}")
      math(EXPR number "${number} + 1")
      set(alone OFF)
      foreach(property SKIP_UNITY_BUILD_INCLUSION COMPILE_OPTIONS COMPILE_DEFINITIONS INCLUDE_DIRECTORIES)
        get_source_file_property(value "${source}" ${property})
        if(value)
          set(alone ON)
        endif()
      endforeach()
      if(NOT alone)
        cmake_path(IS_PREFIX includes "${source}" included)
        if(included)
          cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${includes}" OUTPUT_VARIABLE path)
        elseif(real_build STREQUAL build)
          cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${place}" OUTPUT_VARIABLE path)
        else()
          set(path "${source}")
        endif()
        string(APPEND unit_${layer}_${group} "#include \"${path}\"\n")
        set_source_files_properties("${source}" PROPERTIES HEADER_FILE_ONLY ON)
        list(APPEND units "${layer}_${group}")
      endif()
    endforeach()
  endforeach()
  list(REMOVE_DUPLICATES units)
  foreach(unit ${units})
    file(CONFIGURE OUTPUT "${place}/${unit}.cxx" CONTENT "${unit_${unit}}" @ONLY)
    target_sources(${target} PRIVATE "${place}/${unit}.cxx")
  endforeach()
endfunction()

# robocell_launcher(PATH COMMAND): a program that starts the compiler it is given through ccache, or another one in its place.
function(robocell_launcher path command)
  file(CONFIGURE OUTPUT "${path}.in" @ONLY CONTENT [[#!/bin/sh
# ccache takes precompiled headers when it is told that macros defined before them do not matter.
export CCACHE_SLOPPINESS="${CCACHE_SLOPPINESS:-pch_defines,time_macros}"
# The compiler says which headers it read, so nothing is preprocessed for that alone: a twentieth of a build.
[ -n "${CCACHE_NODEPEND:-}" ] || export CCACHE_DEPEND=1
@command@
]])
  file(COPY_FILE "${path}.in" "${path}" ONLY_IF_DIFFERENT)
  file(CHMOD "${path}" PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE
    WORLD_READ WORLD_EXECUTE)
endfunction()

find_program(CCACHE_PROGRAM ccache)
if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(launcher "${PROJECT_BINARY_DIR}/ccache")  # tools that read the commands know that name
  robocell_launcher("${launcher}" "exec \"${CCACHE_PROGRAM}\" \"$@\"")
  set(CMAKE_CXX_COMPILER_LAUNCHER "${launcher}")
  set(CMAKE_C_COMPILER_LAUNCHER "${launcher}")
endif()

add_library(robocell_flags INTERFACE)
target_compile_options(robocell_flags INTERFACE -Wall -Wextra -Wpedantic -Wno-missing-field-initializers)
# Bit-equal results on every x86-64 machine: no fused multiply-add unless a kernel asks for it.
target_compile_options(robocell_flags INTERFACE -ffp-contract=off)

if(ROBOCELL_SANITIZE)
  set(sanitize "-fsanitize=${ROBOCELL_SANITIZE}" -fno-omit-frame-pointer -g1)
  if(ROBOCELL_SANITIZE MATCHES "undefined")
    # These four double the build time and find nothing that address does not (traps 20).
    list(APPEND sanitize -fno-sanitize=null,alignment,object-size,vptr -fno-sanitize-recover=all)
  endif()
  # g++ 12 warns about std::regex and std::variant once they are instrumented.
  list(APPEND sanitize -Wno-maybe-uninitialized)
  add_compile_options(${sanitize})
  add_link_options(${sanitize})
endif()
