# Installs the program, the libraries, what find_package(pss) needs, and the pages that --help names.
include(CMakePackageConfigHelpers)

install(TARGETS pss_core pss_io pss_stream
        EXPORT pssTargets
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/pss)
install(TARGETS pss)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/docs/ DESTINATION ${CMAKE_INSTALL_DOCDIR})
set(config_dir ${CMAKE_INSTALL_LIBDIR}/cmake/pss)
install(EXPORT pssTargets NAMESPACE pss:: DESTINATION ${config_dir})
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/pssConfig.cmake.in pssConfig.cmake
                              INSTALL_DESTINATION ${config_dir})
write_basic_package_version_file(pssConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/pssConfig.cmake ${PROJECT_BINARY_DIR}/pssConfigVersion.cmake
              ${CMAKE_CURRENT_LIST_DIR}/FindLZ4.cmake ${CMAKE_CURRENT_LIST_DIR}/FindxxHash.cmake
        DESTINATION ${config_dir})
