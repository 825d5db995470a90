# The public headers, which are installed: robocell.h, the bridge to KDL, which needs KDL's headers, and what these
# include. A header becomes public by being included there. scripts/check_includes.py keeps robocell::internal out.
#
# Sets ROBOCELL_HEADER_FOLDERS, relative to src, and for each of them ROBOCELL_HEADERS_<folder>, its headers.
set(source_dir "${PROJECT_SOURCE_DIR}/src")
set(waiting "robocell/robocell.h" "robocell/kinematics/kdl_bridge.h")
set(public "")
while(waiting)
  list(POP_FRONT waiting header)
  if(header IN_LIST public)
    continue()
  endif()
  list(APPEND public "${header}")
  file(STRINGS "${source_dir}/${header}" includes REGEX "^#include \"robocell/")
  list(TRANSFORM includes REPLACE "^#include \"(.*)\".*$" "\\1")
  list(APPEND waiting ${includes})
endwhile()

set(ROBOCELL_HEADER_FOLDERS "")
foreach(header ${public})
  cmake_path(GET header PARENT_PATH folder)
  list(APPEND ROBOCELL_HEADER_FOLDERS "${folder}")
  list(APPEND "ROBOCELL_HEADERS_${folder}" "${source_dir}/${header}")
endforeach()
list(REMOVE_DUPLICATES ROBOCELL_HEADER_FOLDERS)
