# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` puts where (the command: src/cli/CMakeLists.txt), and the package by which
# find_package(relumine) finds it again.
include(CMakePackageConfigHelpers)

set(RELUMINE_PACKAGE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/relumine)
string(REGEX MATCH "^[0-9]+" RELUMINE_EMBREE_MAJOR "${embree_VERSION}")  # users must link the one we compiled against

target_link_libraries(relumine INTERFACE $<INSTALL_INTERFACE:$<LINK_ONLY:TinyGLTF::TinyGLTF>>)
install(TARGETS relumine EXPORT relumineTargets
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY include/relumine DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} FILES_MATCHING PATTERN "*.hpp")
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR})

install(EXPORT relumineTargets NAMESPACE relumine:: DESTINATION ${RELUMINE_PACKAGE_DIR})
configure_package_config_file(cmake/relumineConfig.cmake.in ${PROJECT_BINARY_DIR}/relumineConfig.cmake
                              INSTALL_DESTINATION ${RELUMINE_PACKAGE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/relumineConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/relumineConfig.cmake ${PROJECT_BINARY_DIR}/relumineConfigVersion.cmake
        DESTINATION ${RELUMINE_PACKAGE_DIR})
