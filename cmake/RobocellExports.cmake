# What librobocell shows: the names of the namespace robocell, but not of robocell::internal, nor of what it is made with
# (templates of Eigen, fmt, yaml-cpp and others, which a program may have in another version).
#
# Sets ROBOCELL_EXPORTS, a version script for the linker. In such a script a wildcard of shown names beats one of hidden
# names, so that "all but internal" is spelled letter by letter: names that do not begin with 8internal, as g++ and clang
# write the name of a namespace of eight letters.
set(ROBOCELL_EXPORTS "${PROJECT_BINARY_DIR}/robocell.map")

set(kinds
  N N[KOR] NK[OR]                        # variables and functions; const, & and && members
  T[ISVTWHC]N                            # type information, tables, thread-local variables
  Th*_N Th*_NK Tv*_N Tv*_NK Tc*_N Tc*_NK  # entries of tables for other bases
  ZN ZNK GVN GVZN GVZNK GRN)             # static variables of inline functions, and their guards
set(shown "")
foreach(kind ${kinds})
  set(begin "")
  foreach(letter 8 i n t e r n a l)
    string(APPEND shown "    _Z${kind}8robocell${begin}[!${letter}]*;\n")
    string(APPEND begin "${letter}")
  endforeach()
endforeach()
file(CONFIGURE OUTPUT "${ROBOCELL_EXPORTS}" CONTENT "{\n  global:\n${shown}  local:\n    *;\n};\n")
