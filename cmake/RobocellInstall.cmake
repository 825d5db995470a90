# Where things go: `cmake --install` for C++ users, or the Python wheel (SKBUILD), in which the package's folder holds
# everything: library and extension at its top, include/, lib/cmake/robocell/, models/. MuJoCo is never copied; it is
# found beside the package (mujoco's own wheel) or where it was at build time.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

if(SKBUILD)
  set(lib_dir ".")
  set(include_dir "include")
  set(cmake_dir "lib/cmake/robocell")
  set(models_dir ".")
else()
  set(lib_dir "${CMAKE_INSTALL_LIBDIR}")
  set(include_dir "${CMAKE_INSTALL_INCLUDEDIR}")
  set(cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/robocell")
  set(models_dir "${CMAKE_INSTALL_DATADIR}/robocell")
endif()

if(SKBUILD)
  set(namelink NAMELINK_SKIP)  # a wheel knows no links: it would hold the library twice
else()
  set(namelink NAMELINK_COMPONENT development)
endif()
install(TARGETS robocell EXPORT robocellTargets
  LIBRARY DESTINATION "${lib_dir}" ${namelink} INCLUDES DESTINATION "${include_dir}")
install(TARGETS robocell_warm_start LIBRARY DESTINATION "${lib_dir}")
install(TARGETS robocell_drawing_service RUNTIME DESTINATION "${lib_dir}")
include(RobocellHeaders)
foreach(folder ${ROBOCELL_HEADER_FOLDERS})
  install(FILES ${ROBOCELL_HEADERS_${folder}} DESTINATION "${include_dir}/${folder}")
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/models" DESTINATION "${models_dir}")
# Ready-made environments and the robots that they name, where they find each other and the models.
if(EXISTS "${PROJECT_SOURCE_DIR}/examples/envs")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/examples/envs" DESTINATION "${models_dir}/examples")
  foreach(robot xarm7 gen3_2f85 panda)
    install(FILES "${PROJECT_SOURCE_DIR}/examples/${robot}.yaml" DESTINATION "${models_dir}/examples")
  endforeach()
endif()

# One config file for the installed tree, the wheel and the build folder: it uses no path of its own.
file(COPY "${PROJECT_SOURCE_DIR}/cmake/RobocellMujoco.cmake" DESTINATION "${PROJECT_BINARY_DIR}")
configure_file("${PROJECT_SOURCE_DIR}/cmake/robocellConfig.cmake.in" "${PROJECT_BINARY_DIR}/robocellConfig.cmake" @ONLY)
write_basic_package_version_file("${PROJECT_BINARY_DIR}/robocellConfigVersion.cmake" COMPATIBILITY SameMinorVersion)
install(EXPORT robocellTargets NAMESPACE robocell:: DESTINATION "${cmake_dir}")
install(FILES "${PROJECT_BINARY_DIR}/robocellConfig.cmake" "${PROJECT_BINARY_DIR}/robocellConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/RobocellMujoco.cmake"
  DESTINATION "${cmake_dir}")
export(EXPORT robocellTargets NAMESPACE robocell:: FILE "${PROJECT_BINARY_DIR}/robocellTargets.cmake")

if(SKBUILD AND TARGET _core)
  install(TARGETS _core LIBRARY DESTINATION .)
  install(DIRECTORY "${ROBOCELL_PYTHON_DIR}/" DESTINATION . FILES_MATCHING PATTERN "*.pyi")
endif()
